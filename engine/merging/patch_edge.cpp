#include "engine/merging/patch_edge.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/grid.h"

namespace spoonbill {

namespace {

constexpr const char* names[] = {"u_start", "u_end", "v_start", "v_end"};

// Shorter edges are poles.
constexpr double pole_share = 1e-6;

Vector3 blended(const EdgeCurve& curve, double t, int derivative_order) {
  const BasisFunctions basis = basis_functions(curve.knots, curve.knots.into_domain(t));
  Vector3 sum = Vector3::Zero();
  for (int j = 0; j <= curve.knots.degree(); ++j) {
    sum +=
        basis.values[derivative_order][j] * curve.control_points_m[curve.knots.control_index(basis.span, j)];
  }
  return sum;
}

// At least so many chords, and in every piece some, tell the arc length well enough.
constexpr int least_chords = 256, least_chords_in_piece = 8;

std::vector<double> fine_parameters(const KnotVector& knots) {
  const int pieces = static_cast<int>(knots.breakpoints().size()) - 1;
  const int in_piece = std::max(least_chords_in_piece, (least_chords + pieces - 1) / pieces);
  return nested_parameters(knots, in_piece, 0).parameters;
}

constexpr int directions_looked_at = 48;

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
  return longest > pole_share * bounding_box(surface.net).size();
}

Vector3 outward(const Surface& surface, Side side) {
  const bool across_u = across(side) == Direction::u;
  const KnotVector &fixed = knots_along(surface, across(side)), &along = across_u ? surface.v : surface.u;
  const double at = is_start(side) ? fixed.domain_start() : fixed.domain_end();
  Vector3 sum = Vector3::Zero();
  for (const double t : uniform_parameters_without_seam(along, directions_looked_at)) {
    const Vector3 slope = across_u ? evaluate(surface, at, t).du : evaluate(surface, t, at).dv;
    sum += (is_start(side) ? -1.0 : 1.0) * slope.normalized();
  }
  return sum.norm() > 1e-3 * directions_looked_at ? Vector3(sum.normalized()) : Vector3(Vector3::Zero());
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
    const double wanted = lengths.back() * k / steps;
    const auto after = std::lower_bound(lengths.begin() + 1, lengths.end() - 1, wanted);
    const std::size_t chord = static_cast<std::size_t>(after - lengths.begin()) - 1;
    const double step = lengths[chord + 1] - lengths[chord];
    const double share = step > 0.0 ? std::clamp((wanted - lengths[chord]) / step, 0.0, 1.0) : 0.0;
    samples.parameters.push_back(fine[chord] + share * (fine[chord + 1] - fine[chord]));
  }
  for (const double t : samples.parameters) samples.points_m.push_back(position(curve, t));
  return samples;
}

}  // namespace spoonbill
