#include "render/passes/shadow_area.h"

#include <algorithm>
#include <cmath>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

constexpr float contact_margin_m = 0.012f;

// Carries points along the light onto the ground, to the clip space of a square map. sign +1 keeps the
// highest point in front, -1 the lowest.
Eigen::Matrix4f ground_projection(const ShadowArea& area, const Eigen::Vector3f& along, float ground_y_m,
                                  float sign) {
  const float to_clip = 2.0f / area.side_m;
  const float skew_x = -along.x() / along.y(), skew_z = -along.z() / along.y();
  Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
  m(0, 0) = to_clip;
  m(0, 1) = to_clip * skew_x;
  m(0, 3) = to_clip * (-skew_x * ground_y_m - area.corner_m.x()) - 1.0f;
  m(1, 2) = to_clip;
  m(1, 1) = to_clip * skew_z;
  m(1, 3) = to_clip * (-skew_z * ground_y_m - area.corner_m.y()) - 1.0f;
  const float depth = 2.0f / (area.high_m - area.low_m);
  m(2, 1) = -sign * depth;
  m(2, 3) = sign * depth * (ground_y_m + 0.5f * (area.low_m + area.high_m));
  m(3, 3) = 1.0f;
  return m;
}

// The rectangle of the ground that shadows and contact shadows reach.
struct Footprint {
  FloatBox2 box;

  void include_shadow(const Box& caster, float ground_y_m, const Eigen::Vector3f& toward_key) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3f corner = caster.corner(i).cast<float>();
      const float height = std::max(0.0f, corner.y() - ground_y_m);
      const Eigen::Vector2f below(corner.x(), corner.z());
      const Eigen::Vector2f cast =
          below - Eigen::Vector2f(toward_key.x(), toward_key.z()) * (height / toward_key.y());
      const Eigen::Vector2f soft = Eigen::Vector2f::Constant(key_light_spread * height + contact_margin_m);
      box.join({below.cwiseMin(cast) - soft, below.cwiseMax(cast) + soft});
    }
  }
};

// The next size of a row of eight to a doubling.
float quantised_size(float size) {
  const float octave = std::exp2(std::floor(std::log2(size)));
  return octave * std::ceil(8.0f * size / octave) / 8.0f;
}

}  // namespace

ShadowArea shadow_area(const Box& body, const Box& tool, float ground_y_m, const Eigen::Vector3f& toward_key,
                       int map_side_px) {
  Box box = body;
  if (box.is_empty()) box.include(Vector3(0.0, ground_y_m, 0.0));
  Footprint footprint;
  footprint.include_shadow(box, ground_y_m, toward_key);
  if (!tool.is_empty()) footprint.include_shadow(tool, ground_y_m, toward_key);
  const Eigen::Vector2f low = footprint.box.low, high = footprint.box.high;
  ShadowArea area;
  area.side_m = quantised_size((high - low).maxCoeff());
  const float step = area.side_m / 64.0f;
  area.side_m += step;
  const float texel = area.side_m / static_cast<float>(map_side_px);
  const float snap = std::max(1.0f, std::round(step / texel)) * texel;
  area.corner_m = (low / snap).array().floor().matrix() * snap;
  area.used_share = ((high - area.corner_m) / area.side_m).cwiseMin(1.0f);
  area.low_m = static_cast<float>(box.low.y()) - ground_y_m - 0.001f;
  area.high_m = static_cast<float>(box.high.y()) - ground_y_m + 0.001f;
  area.key_to_clip = ground_projection(area, toward_key, ground_y_m, 1.0f);
  area.sky_to_clip = ground_projection(area, Eigen::Vector3f::UnitY(), ground_y_m, -1.0f);
  return area;
}

}  // namespace spoonbill
