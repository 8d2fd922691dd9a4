#include "engine/fitting/outer_side.h"

#include <cmath>
#include <vector>

namespace spoonbill {
namespace {

constexpr int samples = 32;
// Of the way from the middle: a cap is flat whose height is below a sixtieth of its width.
constexpr double flat_share = 0.05;
// Of the length of the mean normal: along less than this of an axis a surface is upright.
constexpr double upright_share = 0.1;

struct Samples {
  std::vector<Vector3> points_m, areas;  // u-minor
};

Samples samples_of(const Surface& surface) {
  Samples taken;
  for (int j = 0; j < samples; ++j) {
    for (int i = 0; i < samples; ++i) {
      const SurfacePoint at = evaluate(surface, (i + 0.5) / samples, (j + 0.5) / samples);
      taken.points_m.push_back(at.position_m);
      taken.areas.push_back(at.du.cross(at.dv));
    }
  }
  return taken;
}

bool faces_down(const std::vector<Vector3>& areas) {
  Vector3 whole = Vector3::Zero();
  for (const Vector3& area : areas) whole += area;
  for (const int axis : {2, 1}) {
    if (std::abs(whole[axis]) > upright_share * whole.norm()) return whole[axis] < 0.0;
  }
  return whole[0] < 0.0;
}

}  // namespace

bool faces_inner_side(const Surface& surface) {
  const Samples taken = samples_of(surface);
  // Of each ring of a tube, of all of a sheet.
  const std::size_t group = surface.u.is_periodic() ? samples : taken.points_m.size();
  double outwards = 0.0, whole = 0.0;
  for (std::size_t first = 0; first < taken.points_m.size(); first += group) {
    Vector3 middle = Vector3::Zero();
    for (std::size_t k = first; k < first + group; ++k) {
      middle += taken.points_m[k] / static_cast<double>(group);
    }
    for (std::size_t k = first; k < first + group; ++k) {
      const Vector3 way = taken.points_m[k] - middle;
      outwards += way.dot(taken.areas[k]);
      whole += way.norm() * taken.areas[k].norm();
    }
  }
  return std::abs(outwards) > flat_share * whole ? outwards < 0.0 : faces_down(taken.areas);
}

}  // namespace spoonbill
