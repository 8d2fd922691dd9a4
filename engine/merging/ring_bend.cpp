#include "engine/merging/ring_bend.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"

namespace spoonbill {

namespace {

constexpr int samples_around = 64;

Vector3 middle_of_column(const ControlNet& net, int column) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < net.rows; ++i) sum += net.point(i, column);
  return sum / net.rows;
}

// Hermite's cubic: from 0 to 1 with the two slopes.
Vector3 on_cubic(const Vector3& from, const Vector3& to, const Vector3& out, const Vector3& in, double s) {
  const double t = 1.0 - s;
  return t * t * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * t) * to + t * t * s * out - s * s * t * in;
}

}  // namespace

RingPlace ring_place(const Surface& surface, Side side) {
  const EdgeCurve ring = edge_curve(surface, side);
  RingPlace place;
  place.outward = outward(surface, side);
  const std::vector<double> around = uniform_parameters_without_seam(ring.knots, samples_around);
  for (const double t : around) place.centre_m += position(ring, t) / samples_around;
  for (const double t : around) {
    place.radius_m = std::max(place.radius_m, (position(ring, t) - place.centre_m).norm());
  }
  return place;
}

Eigen::Matrix3d turn_towards(const RingPlace& a, const RingPlace& b) {
  const Vector3 inward_b = -b.outward, apart = b.centre_m - a.centre_m;
  const double cosine = inward_b.dot(a.outward);
  const bool within = apart.norm() < std::max(a.radius_m, b.radius_m);
  const bool nowhere = a.outward.isZero() || b.outward.isZero();
  if (nowhere || (cosine < 0.0 && within)) return Eigen::Matrix3d::Identity();
  constexpr double facing_the_same_way = -0.999;
  if (cosine > facing_the_same_way) {
    return Eigen::Quaterniond::FromTwoVectors(inward_b, a.outward).toRotationMatrix();
  }
  const Vector3 axis = apart.cross(a.outward);
  if (!(axis.norm() > 1e-6 * apart.norm())) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(std::numbers::pi, axis.normalized()).toRotationMatrix();
}

bool is_bend(const Eigen::Matrix3d& turn) {
  return Eigen::AngleAxisd(turn).angle() > 0.25 * std::numbers::pi;
}

double bend_stretch(const Eigen::Matrix3d& turn) {
  const double half = 0.5 * Eigen::AngleAxisd(turn).angle();
  return half > 0.0 ? half / std::sin(half) : 1.0;
}

void fill_bend(ControlNet& net, int first, int last, const Vector3& outward, const Eigen::Matrix3d& turn) {
  SPOONBILL_ASSERT(first >= 0 && first <= last && last < net.columns);
  const Vector3 from = middle_of_column(net, first), to = middle_of_column(net, last);
  const Eigen::AngleAxisd whole(Eigen::Matrix3d(turn.transpose()));
  // The slopes with which Hermite's cubic is nearest to an arc.
  const double half = 0.5 * whole.angle();
  const double slope = (to - from).norm() * (half > 0.0 ? 2.0 * std::tan(0.5 * half) / std::sin(half) : 1.0);
  const Vector3 out = slope * outward, in = slope * (turn.transpose() * outward);
  for (int column = first + 1; column < last; ++column) {
    const double share = static_cast<double>(column - first) / (last - first);
    const Vector3 middle = on_cubic(from, to, out, in, share);
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(share * whole.angle(), whole.axis()).toRotationMatrix();
    for (int i = 0; i < net.rows; ++i) {
      const Vector3 of_first = net.point(i, first) - from, of_last = turn * (net.point(i, last) - to);
      net.set_point(i, column, middle + turned * ((1.0 - share) * of_first + share * of_last));
    }
  }
}

}  // namespace spoonbill
