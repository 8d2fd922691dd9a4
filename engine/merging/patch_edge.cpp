#include "engine/merging/patch_edge.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/grid.h"

namespace spoonbill {
namespace {

constexpr const char* names[] = {"u_start", "u_end", "v_start", "v_end"};

// Edges shorter than this fraction of the patch's size count as poles.
constexpr double pole_fraction = 1e-6;

Vector3 blended(const EdgeCurve& curve, double t, int derivative_order) {
  const BasisFunctions basis = basis_functions(curve.knots, curve.knots.into_domain(t));
  Vector3 sum = Vector3::Zero();
  for (int j = 0; j <= curve.knots.degree(); ++j) {
    sum +=
        basis.values[derivative_order][j] * curve.control_points_m[curve.knots.control_index(basis.span, j)];
  }
  return sum;
}

// Smallest numbers of chords from which an arc length is computed: in total, and in each piece.
constexpr int least_chords = 256, least_chords_in_piece = 8;

std::vector<double> fine_parameters(const KnotVector& knots) {
  const int pieces = static_cast<int>(knots.breakpoints().size()) - 1;
  const int in_piece = std::max(least_chords_in_piece, (least_chords + pieces - 1) / pieces);
  return nested_parameters(knots, in_piece, 0).parameters;
}

constexpr int direction_samples = 48;

}  // namespace

Direction across(Side side) {
  return side == Side::u_start || side == Side::u_end ? Direction::u : Direction::v;
}

bool is_start(Side side) {
  return side == Side::u_start || side == Side::v_start;
}

Side opposite(Side side) {
  switch (side) {
    case Side::u_start:
      return Side::u_end;
    case Side::u_end:
      return Side::u_start;
    case Side::v_start:
      return Side::v_end;
    case Side::v_end:
      break;
  }
  return Side::v_start;
}

const char* side_name(Side side) {
  return names[static_cast<int>(side)];
}

EdgeCurve edge_curve(const Surface& surface, Side side) {
  SPOONBILL_ASSERT(has_matching_net(surface));
  const bool across_u = across(side) == Direction::u;
  const KnotVector& fixed = knots_along(surface, across(side));
  const BasisFunctions basis =
      basis_functions(fixed, is_start(side) ? fixed.domain_start() : fixed.domain_end());
  EdgeCurve curve{across_u ? surface.v : surface.u, {}};
  for (int k = 0; k < curve.knots.control_point_count(); ++k) {
    Vector3 point = Vector3::Zero();
    for (int j = 0; j <= fixed.degree(); ++j) {
      const int line = fixed.control_index(basis.span, j);
      point += basis.values[0][j] * (across_u ? surface.net.point(line, k) : surface.net.point(k, line));
    }
    curve.control_points_m.push_back(point);
  }
  return curve;
}

Vector3 position(const EdgeCurve& curve, double t) {
  return blended(curve, t, 0);
}

Vector3 derivative(const EdgeCurve& curve, double t) {
  return blended(curve, t, 1);
}

bool is_joinable(const Surface& surface, Side side) {
  if (knots_along(surface, across(side)).is_periodic()) return false;
  const EdgeCurve curve = edge_curve(surface, side);
  double longest = 0.0;
  for (const Vector3& point : curve.control_points_m) {
    longest = std::max(longest, (point - curve.control_points_m[0]).norm());
  }
  return longest > pole_fraction * bounding_box(surface.net).size();
}

Vector3 outward(const Surface& surface, Side side) {
  const bool across_u = across(side) == Direction::u;
  const KnotVector &fixed = knots_along(surface, across(side)), &along = across_u ? surface.v : surface.u;
  const double at = is_start(side) ? fixed.domain_start() : fixed.domain_end();
  Vector3 sum = Vector3::Zero();
  for (const double t : uniform_parameters_without_seam(along, direction_samples)) {
    const Vector3 slope = across_u ? evaluate(surface, at, t).du : evaluate(surface, t, at).dv;
    sum += (is_start(side) ? -1.0 : 1.0) * slope.normalized();
  }
  return sum.norm() > 1e-3 * direction_samples ? Vector3(sum.normalized()) : Vector3(Vector3::Zero());
}

EdgeSamples edge_samples(const EdgeCurve& curve, int count) {
  SPOONBILL_ASSERT(count >= 2);
  const std::vector<double> fine = fine_parameters(curve.knots);
  std::vector<double> lengths{0.0};
  std::vector<Vector3> points;
  for (const double t : fine) {
    points.push_back(position(curve, t));
    if (points.size() > 1) lengths.push_back(lengths.back() + (points.back() - points.end()[-2]).norm());
  }
  EdgeSamples samples{{}, {}, lengths.back()};
  const int steps = curve.knots.is_periodic() ? count : count - 1;
  for (int k = 0; k < count; ++k) {
    const double target = lengths.back() * k / steps;
    const auto after = std::lower_bound(lengths.begin() + 1, lengths.end() - 1, target);
    const std::size_t chord = static_cast<std::size_t>(after - lengths.begin()) - 1;
    const double step = lengths[chord + 1] - lengths[chord];
    const double fraction = step > 0.0 ? std::clamp((target - lengths[chord]) / step, 0.0, 1.0) : 0.0;
    samples.parameters.push_back(fine[chord] + fraction * (fine[chord + 1] - fine[chord]));
  }
  for (const double t : samples.parameters) samples.points_m.push_back(position(curve, t));
  return samples;
}

namespace {

constexpr int frame_samples = 64;

Vector3 column_centre(const ControlNet& net, int column) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < net.rows; ++i) sum += net.point(i, column);
  return sum / net.rows;
}

// Returns the point at s, from 0 to 1, of the Hermite cubic from `from` to `to` with the slopes `out` and
// `in` at its ends.
Vector3 on_cubic(const Vector3& from, const Vector3& to, const Vector3& out, const Vector3& in, double s) {
  const double t = 1.0 - s;
  return t * t * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * t) * to + t * t * s * out - s * s * t * in;
}

}  // namespace

RingFrame ring_frame(const Surface& surface, Side side) {
  const EdgeCurve ring = edge_curve(surface, side);
  RingFrame frame;
  frame.outward = outward(surface, side);
  const std::vector<double> parameters = uniform_parameters_without_seam(ring.knots, frame_samples);
  for (const double t : parameters) frame.centre_m += position(ring, t) / frame_samples;
  for (const double t : parameters) {
    frame.radius_m = std::max(frame.radius_m, (position(ring, t) - frame.centre_m).norm());
  }
  return frame;
}

Eigen::Matrix3d rotation_towards(const RingFrame& a, const RingFrame& b) {
  const Vector3 inward_b = -b.outward, offset = b.centre_m - a.centre_m;
  const double cosine = inward_b.dot(a.outward);
  const bool within = offset.norm() < std::max(a.radius_m, b.radius_m);
  const bool nowhere = a.outward.isZero() || b.outward.isZero();
  if (nowhere || (cosine < 0.0 && within)) return Eigen::Matrix3d::Identity();
  constexpr double same_direction_cosine = -0.999;
  if (cosine > same_direction_cosine) {
    return rotation_between(inward_b, a.outward).toRotationMatrix();
  }
  const Vector3 axis = offset.cross(a.outward);
  if (!(axis.norm() > 1e-6 * offset.norm())) return Eigen::Matrix3d::Identity();
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
  const Vector3 from = column_centre(net, first), to = column_centre(net, last);
  const Eigen::AngleAxisd whole(Eigen::Matrix3d(turn.transpose()));
  // With these slopes the Hermite cubic is closest to a circular arc.
  const double half = 0.5 * whole.angle();
  const double slope = (to - from).norm() * (half > 0.0 ? 2.0 * std::tan(0.5 * half) / std::sin(half) : 1.0);
  const Vector3 out = slope * outward, in = slope * (turn.transpose() * outward);
  for (int column = first + 1; column < last; ++column) {
    const double fraction = static_cast<double>(column - first) / (last - first);
    const Vector3 centre = on_cubic(from, to, out, in, fraction);
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(fraction * whole.angle(), whole.axis()).toRotationMatrix();
    for (int i = 0; i < net.rows; ++i) {
      const Vector3 offset_first = net.point(i, first) - from, offset_last = turn * (net.point(i, last) - to);
      net.set_point(i, column,
                    centre + rotation * ((1.0 - fraction) * offset_first + fraction * offset_last));
    }
  }
}

}  // namespace spoonbill
