#include "render/overlay/control_net.h"

namespace spoonbill {
namespace {

constexpr float width_px = 1.1f;

// Diamonds are sized on the screen alone.
constexpr float radius_m = 0.0f;
constexpr float radius_px = 2.0f;

}  // namespace

void append_control_net(const SurfaceSnapshot& surface, std::vector<OverlayLine>& lines,
                        std::vector<OverlayMark>& marks) {
  const int rows = surface.u.control_point_count(), columns = surface.v.control_point_count();
  const auto point = [&](int i, int j) {
    const auto at = static_cast<std::size_t>((i % rows) * columns + j % columns);
    return Eigen::Vector3f(surface.x[at], surface.y[at], surface.z[at]);
  };
  const auto join = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    lines.push_back({a, b, palette::control_net, palette::control_net, width_px});
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      if (i + 1 < rows || surface.u.is_periodic()) join(point(i, j), point(i + 1, j));
      if (j + 1 < columns || surface.v.is_periodic()) join(point(i, j), point(i, j + 1));
      marks.push_back(
          {point(i, j), palette::control_net, radius_m, radius_px, static_cast<float>(MarkShape::diamond)});
    }
  }
}

}  // namespace spoonbill
