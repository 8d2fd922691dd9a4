#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/base/assert.h"
#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

constexpr double cells_across_view = 22.0;
constexpr int strong_every = 5;
constexpr double fade_end_fraction = 0.85;    // grid radius / visible width at the target
constexpr double fade_start_fraction = 0.30;  // radius at which fading starts / grid radius
constexpr std::uint8_t strong_alpha = 88, thin_alpha = 46;
constexpr float line_width_px = 1.0f;
constexpr int pieces_per_line = 12;

constexpr double bar_width_fraction = 0.17;
// Distance of the bar from the top of the area that no panel covers, as a fraction of the area's height.
constexpr double bar_height_fraction = 0.87;
constexpr float bar_width_px = 2.2f;

std::uint8_t faded(double alpha, double distance_m, double radius_m) {
  const double t =
      std::clamp((distance_m / radius_m - fade_start_fraction) / (1.0 - fade_start_fraction), 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(alpha * (1.0 - t * t * (3.0 - 2.0 * t))));
}

// Appends a grid line along `axis`, at `offset_m` on the other horizontal axis. The line consists of pieces,
// so that it can fade out.
void append_faded_line(int axis, double offset_m, const Vector3& centre, double radius_m, Colour strongest,
                       std::vector<OverlayLine>& lines) {
  const int other = 2 - axis;
  const double across = offset_m - centre[other];
  const double half = std::sqrt(std::max(0.0, radius_m * radius_m - across * across));
  const auto at = [&](int piece) {
    Vector3 point = centre;
    point[other] = offset_m;
    point[axis] = centre[axis] + half * (2.0 * piece / pieces_per_line - 1.0);
    return point;
  };
  const auto colour_at = [&](const Vector3& point) {
    Colour colour = strongest;
    colour.a = faded(strongest.a, (point - centre).norm(), radius_m);
    return colour;
  };
  for (int piece = 0; piece < pieces_per_line; ++piece) {
    const Vector3 a = at(piece), b = at(piece + 1);
    const Colour colour_a = colour_at(a), colour_b = colour_at(b);
    if (colour_a.a == 0 && colour_b.a == 0) continue;
    lines.push_back({a.cast<float>(), b.cast<float>(), colour_a, colour_b, line_width_px});
  }
}

}  // namespace

double round_length_below(double length) {
  SPOONBILL_ASSERT(length > 0.0);
  const double decade = std::pow(10.0, std::floor(std::log10(length) + 1e-9));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= length * (1.0 + 1e-9)) return factor * decade;
  }
  return decade;
}

void append_ground_grid(const Camera& camera, const Viewport& viewport, double ground_y_m, Colour colour,
                        std::vector<OverlayLine>& lines) {
  const double width_m = viewport.free_px.width / pixels_per_metre(camera, viewport);
  const double cell_m = std::pow(10.0, std::round(std::log10(width_m / cells_across_view)));
  const double radius_m = fade_end_fraction * width_m;
  const Vector3 centre(camera.target_m.x(), ground_y_m, camera.target_m.z());
  for (const int axis : {0, 2}) {
    const int other = 2 - axis;
    const auto first = static_cast<long>(std::ceil((centre[other] - radius_m) / cell_m));
    const auto last = static_cast<long>(std::floor((centre[other] + radius_m) / cell_m));
    for (long i = first; i <= last; ++i) {
      colour.a = i % strong_every == 0 ? strong_alpha : thin_alpha;
      append_faded_line(axis, static_cast<double>(i) * cell_m, centre, radius_m, colour, lines);
    }
  }
}

std::string ScaleBar::text() const {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g mm", length_m * 1e3);
  return text.data();
}

std::optional<ScaleBar> ground_scale_bar(const Camera& camera, const Viewport& viewport, double ground_y_m) {
  const Rectangle& free = viewport.free_px;
  const Eigen::Vector2d pixel(free.x + 0.5 * free.width, free.y + bar_height_fraction * free.height);
  const auto centre = point_on_height(camera, viewport, pixel, ground_y_m);
  if (!centre) return std::nullopt;
  const Vector3 right = eye_axes(camera).col(0);
  const double depth_m = (eye_position(camera) - *centre).dot(eye_axes(camera).col(2));
  const double scale = pixels_per_metre(camera, viewport) * camera.distance_m / depth_m;
  // A bar far toward the horizon would not show the size of the model.
  const bool near_model = depth_m < 3.0 * camera.distance_m;
  if (!near_model) return std::nullopt;
  const double length_m = round_length_below(bar_width_fraction * free.width / scale);
  return ScaleBar{*centre - 0.5 * length_m * right, *centre + 0.5 * length_m * right, length_m};
}

void append_scale_bar(const ScaleBar& bar, const Camera& camera, Colour colour,
                      std::vector<OverlayLine>& lines) {
  const Eigen::Matrix3d axes = eye_axes(camera);
  // The ticks at the ends of the bar are on the ground and perpendicular to the bar.
  const Vector3 across = axes.col(0).cross(Vector3::UnitY());
  const Vector3 tick = 0.045 * bar.length_m * across;
  const auto add = [&](const Vector3& a, const Vector3& b) {
    lines.push_back({a.cast<float>(), b.cast<float>(), colour, colour, bar_width_px});
  };
  add(bar.start_m, bar.end_m);
  add(bar.start_m - tick, bar.start_m + tick);
  add(bar.end_m - tick, bar.end_m + tick);
}

}  // namespace spoonbill
