#include "tests/engine/collision/solids/signed_distance_check.h"

#include <cmath>
#include <string>

#include "engine/base/text.h"

namespace spoonbill {
namespace {

constexpr int sample_count = 4000;
constexpr double unit_tolerance = 1e-6;
// `growth_tolerance` is relative to the distance between two samples, `rounding` to the size of the box.
constexpr double growth_tolerance = 1e-6, rounding = 1e-11;
constexpr double difference_step = 1e-6;  // relative to the box's size
constexpr double difference_tolerance = 1e-3, most_misfits = 0.02;

// Returns point k of a Halton sequence (1960) in the unit cube. The points of the sequence are evenly
// distributed, and the same on every machine.
Vector3 spread(int k) {
  Vector3 result;
  const int bases[3] = {2, 3, 5};
  for (int axis = 0; axis < 3; ++axis) {
    double share = 1.0, sum = 0.0;
    for (int rest = k; rest > 0; rest /= bases[axis]) {
      share /= bases[axis];
      sum += share * (rest % bases[axis]);
    }
    result[axis] = sum;
  }
  return result;
}

std::string text(const Vector3& p) {
  return "(" + number_text(p.x()) + ", " + number_text(p.y()) + ", " + number_text(p.z()) + ") m";
}

Error refusal(const std::string& what, const Vector3& where, const std::string& remedy) {
  return Error{ErrorCode::internal, "signed distance: " + what + " at " + text(where) + "; " + remedy};
}

Status check_finite(const Vector3& point, const DistanceSample& sample) {
  if (std::isfinite(sample.distance_m) && sample.gradient.allFinite()) return {};
  return refusal("not finite", point, "at() must give numbers everywhere");
}

Status check_alone(const SignedDistance& solid, const Vector3& point, const DistanceSample& sample) {
  if (Status status = check_finite(point, sample); !status) return status;
  const double length = sample.gradient.norm();
  if (std::abs(length - 1.0) > unit_tolerance) {
    return refusal("a gradient of length " + number_text(length), point, "make it of length 1");
  }
  const Box bounds = solid.bounds();
  if (sample.distance_m < 0.0 && !bounds.holds({point, point})) {
    return refusal("inside the solid but outside bounds()", point, "widen the bounds");
  }
  return {};
}

Status check_both(const SignedDistance& solid, const Vector3& a, const DistanceSample& at_a, const Vector3& b,
                  double size) {
  const DistanceSample at_b = solid.at(b);
  if (Status status = check_finite(b, at_b); !status) return status;
  const double way = (b - a).norm(), slack = growth_tolerance * way + rounding * size;
  if (!(std::abs(at_b.distance_m - at_a.distance_m) <= way + slack)) {
    return refusal("changes by more than the way to " + text(b), a, "divide it by its steepest slope");
  }
  const double concavity = solid.is_convex() ? 0.0 : solid.concavity(a, way);
  if (!std::isfinite(concavity)) return {};
  const double tangent = at_a.distance_m + at_a.gradient.dot(b - a) - 0.5 * concavity * way * way;
  if (tangent > at_b.distance_m + slack) {
    return refusal("a tangent lies above the distance", a,
                   solid.is_convex() ? "is_convex() must be false" : "concavity() must be larger");
  }
  return {};
}

bool fits_differences(const SignedDistance& solid, const Vector3& point, const Vector3& gradient,
                      double step) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 move = step * Vector3::Unit(axis);
    const double slope =
        (solid.at(point + move).distance_m - solid.at(point - move).distance_m) / (2.0 * step);
    if (!(std::abs(slope - gradient[axis]) <= difference_tolerance)) return false;
  }
  return true;
}

}  // namespace

Status check_signed_distance(const SignedDistance& solid, const Box& where) {
  const Box bounds = solid.bounds();
  if (bounds.low.hasNaN() || bounds.high.hasNaN() || !(bounds.low.array() <= bounds.high.array()).all()) {
    return Error{ErrorCode::internal,
                 "signed distance: bounds() has a low corner above its high one; give low <= high"};
  }
  const Vector3 sides = where.high - where.low;
  const double size = where.size();
  if (!(sides.minCoeff() > 0.0 && std::isfinite(size))) {
    return Error{ErrorCode::internal,
                 "signed distance: the box to sample is empty or endless; give one around the solid"};
  }
  const auto point = [&](int k) -> Vector3 { return where.low + sides.cwiseProduct(spread(k)); };
  int misfits = 0;
  Vector3 misfit = Vector3::Zero();
  for (int k = 1; k <= sample_count; ++k) {
    const Vector3 here = point(k), other = point(sample_count + 1 - k);
    const DistanceSample sample = solid.at(here);
    if (Status status = check_alone(solid, here, sample); !status) return status;
    // The samples of a pair are far from, near to or very near to each other.
    for (const double share : {1.0, 0.05, 0.001}) {
      const Vector3 there = here + share * (other - here);
      if (Status status = check_both(solid, here, sample, there, size); !status) return status;
    }
    if (fits_differences(solid, here, sample.gradient, difference_step * size)) continue;
    ++misfits;
    misfit = here;
  }
  if (misfits <= most_misfits * sample_count) return {};
  return refusal("the gradient is not the slope in " + std::to_string(misfits) + " of " +
                     std::to_string(sample_count) + " samples, such as",
                 misfit, "give the gradient of this distance");
}

}  // namespace spoonbill
