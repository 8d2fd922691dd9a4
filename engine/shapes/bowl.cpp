#include "engine/shapes/bowl.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/base/text.h"

namespace spoonbill {
namespace {

// Half the thickness of the wall at a distance from the edge, T(e) = h erf(sqrt(pi / 4) s) with
// s = sqrt(2 e / h). The section of the rim is then round with the radius h at the edge, and the wall is 2 h
// thick to about 1 % where e exceeds 2 h.
double half_thickness_m(double half_wall_m, double s) {
  return half_wall_m * std::erf(0.5 * s / std::numbers::inv_sqrtpi);
}

// Returns how far the rim reaches beyond its edge in a direction that is inclined to the wall: the largest
// T(e) sin(angle) - e cos(angle).
double rim_overhang_m(double half_wall_m, double angle) {
  constexpr int steps = 2000;
  constexpr double largest_s = 4.0;
  double largest = 0.0;
  for (int k = 0; k <= steps; ++k) {
    const double s = largest_s * k / steps;
    largest = std::max(largest, half_thickness_m(half_wall_m, s) * std::sin(angle) -
                                    0.5 * half_wall_m * s * s * std::cos(angle));
  }
  return largest;
}

// The bowl is a unit sphere, pressed flat. A point of the sphere above (x, z) in the unit disc, at the height
// q with q^2 = 1 - x^2 - z^2, becomes a point beside the paraboloid at (x, z), on the upper side if q is
// positive, at the distance T(e). Near the rim e is E q^2 / 2, where E is the distance from the edge for a
// step of 1 towards the centre of the disc, so that T is a smooth function of q.
class PressedSphere {
 public:
  explicit PressedSphere(const BowlSize& size)
      : along_m_(0.5 * size.length_m),
        across_m_(0.5 * size.width_m),
        half_wall_m_(0.5 * size.rim_m),
        depth_m_(size.depth_m),
        cosine_(std::cos(size.pitch_deg * std::numbers::pi / 180.0)),
        sine_(std::sin(size.pitch_deg * std::numbers::pi / 180.0)) {
    // The rim reaches a little beyond the edge. How far depends on the slope of the paraboloid at the edge,
    // which changes little from round to round.
    constexpr int rounds = 20;
    for (int round = 0; round < rounds; ++round) {
      const double slope_along = std::atan(2.0 * depth_m_ / along_m_);
      const double slope_across = std::atan(2.0 * depth_m_ / across_m_);
      const double highest_m =
          rim_overhang_m(half_wall_m_, 0.5 * std::numbers::pi - std::min(slope_along, slope_across));
      along_m_ = 0.5 * size.length_m - rim_overhang_m(half_wall_m_, slope_along);
      across_m_ = 0.5 * size.width_m - rim_overhang_m(half_wall_m_, slope_across);
      depth_m_ = size.depth_m + half_wall_m_ - highest_m;
    }
  }

  Vector3 at(double u, double v) const {
    const double around = -2.0 * std::numbers::pi * u, along = std::numbers::pi * v;
    const double x = -std::cos(along), ring = v <= 0.0 || v >= 1.0 ? 0.0 : std::sin(along);
    const double z = ring * std::cos(around), q = ring * std::sin(around);
    const Vector3 halfway(along_m_ * x, -depth_m_ * q * q, across_m_ * z);
    const Vector3 normal =
        Vector3(-2.0 * depth_m_ * x / along_m_, 1.0, -2.0 * depth_m_ * z / across_m_).normalized();
    const double s = q * std::sqrt(step_from_rim_m(x, z, q) / half_wall_m_);
    return pitched(halfway + half_thickness_m(half_wall_m_, s) * normal);
  }

 private:
  // The E above. At the rim it is |dM/dr x dM/da| / |dM/da|, where r and a are the polar coordinates of the
  // disc and M is the paraboloid; further inside, any smooth function will do.
  double step_from_rim_m(double x, double z, double q) const {
    const double a = along_m_, b = across_m_;
    const double slope = 4.0 * depth_m_ * depth_m_ * (b * b * x * x + a * a * z * z);
    const double turn = a * a * z * z + b * b * x * x + 0.5 * (a * a + b * b) * q * q;
    return std::sqrt((a * a * b * b + slope) / turn);
  }

  Vector3 pitched(const Vector3& point) const {
    return {cosine_ * point.x() - sine_ * point.y(), sine_ * point.x() + cosine_ * point.y(), point.z()};
  }

  double along_m_, across_m_;  // semi-axes of the edge
  double half_wall_m_;
  double depth_m_;  // of the paraboloid
  double cosine_, sine_;
};

}  // namespace

Result<ExactShape> bowl_shape(const BowlSize& size) {
  if (Status status = check_size("length", size.length_m); !status) return status.error();
  if (Status status = check_size("width", size.width_m); !status) return status.error();
  const double shorter = std::min(size.length_m, size.width_m);
  Status status = check_length("width", size.width_m,
                               {size.length_m / max_bowl_slenderness, size.length_m * max_bowl_slenderness});
  if (!status) return status.error();
  status = check_length("depth", size.depth_m,
                        {bowl_depth_fraction_range.low * shorter, bowl_depth_fraction_range.high * shorter});
  if (!status) return status.error();
  status = check_length("rim", size.rim_m,
                        {bowl_rim_fraction_range.low * shorter, bowl_rim_fraction_range.high * shorter});
  if (!status) return status.error();
  if (!bowl_pitch_range_deg.contains(size.pitch_deg)) {
    return Error{ErrorCode::out_of_range,
                 "pitch is " + number_text(size.pitch_deg) + " degrees, must be from " +
                     number_text(bowl_pitch_range_deg.low) + " to " + number_text(bowl_pitch_range_deg.high) +
                     " degrees",
                 "pitch"};
  }
  ExactShape shape;
  shape.u.periodic = true;
  shape.pole_at_start = shape.pole_at_end = true;
  shape.rim = {{0.0, 0.0}, {0.0, 1.0}, {0.5, 1.0}, {0.5, 0.0}};
  shape.at = [sphere = PressedSphere(size)](double u, double v) { return sphere.at(u, v); };
  return shape;
}

double bowl_reach_m(const BowlSize& size) {
  // The section of the rim is curved a third more tightly at its shoulders than at its edge.
  return 0.75 * 0.5 * size.rim_m;
}

}  // namespace spoonbill
