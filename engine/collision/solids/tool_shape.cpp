#include "engine/collision/solids/tool_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

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

// Combines two linear lower bounds, each given by its values at four corners. Every weighted mean of the two
// is also a lower bound. The smallest of its four corner values is a concave function of the weight. Returns
// the maximum of this function.
double best_mix(const CornerValues& a, const CornerValues& b) {
  double low = 0.0, high = 1.0;
  const auto mixed = [&](double fraction) {
    CornerValues values;
    for (int k = 0; k < 4; ++k) values[k] = a[k] + fraction * (b[k] - a[k]);
    return least(values);
  };
  // The best fraction is 0, 1 or a fraction at which two corners have equal values.
  double best = std::max(mixed(low), mixed(high));
  for (int i = 0; i < 4; ++i) {
    for (int k = i + 1; k < 4; ++k) {
      const double slope = (b[i] - a[i]) - (b[k] - a[k]);
      const double fraction = slope != 0.0 ? (a[k] - a[i]) / slope : -1.0;
      if (fraction > 0.0 && fraction < 1.0) best = std::max(best, mixed(fraction));
    }
  }
  return best;
}

// Returns a lower bound of the distance from the hull of a patch's corners to a solid. The distance to a
// convex solid is nowhere below a tangent or a weighted mean of two tangents; means matter at the solid's
// edges. Over the hull, a tangent is lowest at a corner. For other solids, a tangent is lowered by half the
// concavity times the square of the hull's radius. For any solid, the distance at the hull's centre minus the
// hull's radius is a bound.
double solid_bound(const ToolShape& tool, const PatchCorners& corners, double enough) {
  const Vector3 centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  double radius = 0.0;
  for (const Vector3& corner : corners) radius = std::max(radius, (corner - centre).norm());
  const double concavity = tool.distance_field->concavity(tool.into_frame(centre), radius);
  CornerValues at_centre;
  const auto bound_by = [&](const DistanceSample& sample) {
    const double ball = sample.distance_m - radius;
    if (!(concavity < infinity)) return ball;
    at_centre = tangent_at_corners(sample, centre, corners);
    return std::max(ball, least(at_centre) - 0.5 * concavity * radius * radius);
  };
  // The distance to any bounding plane is cheap and often a sufficient bound.
  double bound = bound_by(tool.at_within(centre, -infinity));
  if (bound >= enough || concavity > 0.0) return bound;
  bound = std::max(bound, bound_by(tool.at(centre)));
  if (bound >= enough) return bound;
  std::array<CornerValues, 5> tangents{at_centre};
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
    const Vector3 half = 0.5 * (box.high - box.low), centre = box.low + half;
    const DistanceSample sample = tool.at_within(centre, -infinity);
    const double radius = half.norm(),
                 concavity = tool.distance_field->concavity(tool.into_frame(centre), radius);
    const double ball = sample.distance_m - radius;
    if (!(concavity < infinity)) return ball;
    const double tangent = sample.distance_m - sample.gradient.cwiseAbs().dot(half);
    return std::max(ball, tangent - 0.5 * concavity * radius * radius);
  }
  if (tool.kind == ToolShape::Kind::sphere) {
    return (tool.centre_m - tool.centre_m.cwiseMax(box.low).cwiseMin(box.high)).norm() - tool.radius_m;
  }
  const Vector3 foremost = (tool.normal.array() > 0.0).select(box.low, box.high);
  return tool.distance(foremost);
}

// Returns a lower bound of the tool's distance over a patch. The bilinear patch is inside the hull of its
// corners, and the surface is within `bulge` of the patch. Along any direction, no point of the hull is
// nearer than the nearest corner. The error of this bound is quadratic in the patch's size. A ball around the
// patch would have a linear error, so more patches would have to be cut.
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
  // If the corners are behind the tool's centre along the direction, the bound is negative. The distance from
  // the centre is never negative, so the bound is raised to 0.
  if (tool.kind == ToolShape::Kind::sphere) foremost = std::max(foremost, 0.0);
  return foremost - tool.radius_m - bulge;
}

// Returns the depth of the tool's deepest point behind the plane. The deepest point of a solid is its nearest
// point to a point far behind the plane.
double depth_behind(const ToolShape& tool, const Vector3& point, const Vector3& normal) {
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-6);
  if (tool.kind == ToolShape::Kind::half_space) return infinity;
  if (tool.kind == ToolShape::Kind::sphere) return normal.dot(point - tool.centre_m) + tool.radius_m;
  const Box bounds = tool.distance_field->bounds();
  const double size = bounds.size();
  if (!(size < infinity)) return infinity;
  const Vector3 far_m = tool.centre_m + tool.turn * (0.5 * (bounds.low + bounds.high)) -
                        (1e5 * size + (point - tool.centre_m).norm()) * normal;
  const DistanceSample sample = tool.at(far_m);
  return normal.dot(point - (far_m - sample.distance_m * sample.gradient));
}

}  // namespace spoonbill
