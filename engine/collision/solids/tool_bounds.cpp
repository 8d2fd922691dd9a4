#include "engine/collision/solids/tool_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using CornerValues = std::array<double, 4>;

double least(const CornerValues& values) {
  return std::min(std::min(values[0], values[1]), std::min(values[2], values[3]));
}

CornerValues tangent_at_corners(const DistanceSample& sample, const Vector3& from,
                                const PatchCorners& corners) {
  CornerValues values;
  for (int k = 0; k < 4; ++k) values[k] = sample.distance_m + sample.gradient.dot(corners[k] - from);
  return values;
}

// The largest that the least corner can be made by mixing two tangents: a concave function of the share.
double best_mix(const CornerValues& a, const CornerValues& b) {
  double low = 0.0, high = 1.0;
  const auto mixed = [&](double share) {
    CornerValues values;
    for (int k = 0; k < 4; ++k) values[k] = a[k] + share * (b[k] - a[k]);
    return least(values);
  };
  // The share where two corners meet is the best one or next to none.
  double best = std::max(mixed(low), mixed(high));
  for (int i = 0; i < 4; ++i) {
    for (int k = i + 1; k < 4; ++k) {
      const double slope = (b[i] - a[i]) - (b[k] - a[k]);
      const double share = slope != 0.0 ? (a[k] - a[i]) / slope : -1.0;
      if (share > 0.0 && share < 1.0) best = std::max(best, mixed(share));
    }
  }
  return best;
}

// No convex solid is nearer than any of its tangents says, nor than any mixture of two, which is what tells
// at its edges: the least of a tangent over the hull of the corners is at a corner. Of other solids a tangent
// may fail by half the concavity times the square of the way, and none is nearer than the way moved says.
double solid_bound(const ToolShape& tool, const PatchCorners& corners, double enough) {
  const Vector3 middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  double radius = 0.0;
  for (const Vector3& corner : corners) radius = std::max(radius, (corner - middle).norm());
  const double concavity = tool.made_of->concavity(tool.into_frame(middle), radius);
  CornerValues at_middle;
  const auto bound_by = [&](const DistanceSample& centre) {
    const double ball = centre.distance_m - radius;
    if (!(concavity < infinity)) return ball;
    at_middle = tangent_at_corners(centre, middle, corners);
    return std::max(ball, least(at_middle) - 0.5 * concavity * radius * radius);
  };
  // A plane that takes little work often does.
  double bound = bound_by(tool.at_within(middle, -infinity));
  if (bound >= enough || concavity > 0.0) return bound;
  bound = std::max(bound, bound_by(tool.at(middle)));
  if (bound >= enough) return bound;
  std::array<CornerValues, 5> tangents{at_middle};
  for (int k = 0; k < 4; ++k) {
    tangents[k + 1] = tangent_at_corners(tool.at(corners[k]), corners[k], corners);
    for (int other = 0; other <= k; ++other) {
      bound = std::max(bound, best_mix(tangents[k + 1], tangents[other]));
      if (bound >= enough) return bound;
    }
  }
  return bound;
}

}  // namespace

double lower_bound(const ToolShape& tool, const Box& box) {
  if (tool.is_solid()) {
    const Vector3 half = 0.5 * (box.high - box.low), middle = box.low + half;
    const DistanceSample centre = tool.at_within(middle, -infinity);
    const double radius = half.norm(), concavity = tool.made_of->concavity(tool.into_frame(middle), radius);
    const double ball = centre.distance_m - radius;
    if (!(concavity < infinity)) return ball;
    const double tangent = centre.distance_m - centre.gradient.cwiseAbs().dot(half);
    return std::max(ball, tangent - 0.5 * concavity * radius * radius);
  }
  if (tool.kind == ToolShape::Kind::sphere) {
    return (tool.centre_m - tool.centre_m.cwiseMax(box.low).cwiseMin(box.high)).norm() - tool.radius_m;
  }
  const Vector3 foremost = (tool.normal.array() > 0.0).select(box.low, box.high);
  return tool.distance(foremost);
}

// The bilinear patch lies in the hull of its corners, the surface within `bulge` of that, and no point of a
// hull is nearer than its foremost corner along any one direction. Unlike a ball's, this bound is off by the
// square of the patch's size, so that few patches are cut again.
double lower_bound(const ToolShape& tool, const PatchCorners& corners, double bulge, double enough) {
  SPOONBILL_ASSERT_DEBUG(bulge >= 0.0);
  if (tool.is_solid()) return solid_bound(tool, corners, enough + bulge) - bulge;
  Vector3 direction = tool.normal;
  if (tool.kind == ToolShape::Kind::sphere) {
    direction = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]) - tool.centre_m;
    const double length = direction.norm();
    if (!(length > 0.0)) return -tool.radius_m - bulge;
    direction /= length;
  }
  double foremost = infinity;
  for (const Vector3& corner : corners) foremost = std::min(foremost, direction.dot(corner - tool.centre_m));
  // Behind the centre the direction says nothing; the distance to a point is never below zero.
  if (tool.kind == ToolShape::Kind::sphere) foremost = std::max(foremost, 0.0);
  return foremost - tool.radius_m - bulge;
}

// From far away along a direction, the nearest point of a solid is its farthest along that direction.
double depth_behind(const ToolShape& tool, const Vector3& point, const Vector3& normal) {
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-6);
  if (tool.kind == ToolShape::Kind::half_space) return infinity;
  if (tool.kind == ToolShape::Kind::sphere) return normal.dot(point - tool.centre_m) + tool.radius_m;
  const Box bounds = tool.made_of->bounds();
  const double size = bounds.size();
  if (!(size < infinity)) return infinity;
  const Vector3 far_m = tool.centre_m + tool.turn * (0.5 * (bounds.low + bounds.high)) -
                        (1e5 * size + (point - tool.centre_m).norm()) * normal;
  const DistanceSample sample = tool.at(far_m);
  return normal.dot(point - (far_m - sample.distance_m * sample.gradient));
}

}  // namespace spoonbill
