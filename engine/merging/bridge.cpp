#include "engine/merging/bridge.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/fold_search.h"
#include "engine/merging/ring_bend.h"

namespace spoonbill {

namespace {

// Clamped, of `degree`, with `count` control points and pieces of equal length.
Result<KnotVector> strip_knots(int degree, int count, double start, double end) {
  std::vector<double> knots(static_cast<std::size_t>(degree) + 1, start);
  const int pieces = count - degree;
  for (int k = 1; k < pieces; ++k) knots.push_back(start + (end - start) * k / pieces);
  knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, end);
  return KnotVector::open(degree, std::move(knots));
}

// Control point j of the strip as that of the patch's first or last piece.
void continue_into(const Surface& patch, bool from_end, const KnotVector& strip, int j, ControlNet& net) {
  const double at = from_end ? patch.v.domain_end() : patch.v.domain_start();
  const int span = patch.v.find_span(at);
  std::array<double, max_degree> arguments{};
  for (int k = 0; k < strip.degree(); ++k) arguments[k] = strip.knots()[j + 1 + k];
  const BlossomWeights weights = blossom(patch.v, span, std::span(arguments).first(strip.degree()));
  for (int i = 0; i < net.rows; ++i) {
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k <= patch.v.degree(); ++k) {
      sum += weights[k] * patch.net.point(i, patch.v.control_index(span, k));
    }
    net.set_point(i, j, sum);
  }
}

constexpr double tightening = 0.75;
constexpr int tightenings_for_waist = 5, most_tightenings = 12;
constexpr int steps_along = 24;
constexpr int columns_between = 5;

double mean_radius_m(const Surface& tube, double v) {
  const std::vector<double> around = uniform_parameters_without_seam(tube.u, 32);
  std::vector<Vector3> points;
  Vector3 middle = Vector3::Zero();
  for (const double u : around) {
    points.push_back(position(tube, u, v));
    middle += points.back() / static_cast<double>(around.size());
  }
  double radius = 0.0;
  for (const Vector3& point : points) radius += (point - middle).norm() / static_cast<double>(around.size());
  return radius;
}

bool has_waist(const Surface& strip) {
  const double first = strip.v.domain_start(), last = strip.v.domain_end();
  const double narrowest = std::min(mean_radius_m(strip, first), mean_radius_m(strip, last));
  constexpr double unseen = 0.99;
  for (int k = 1; k < steps_along; ++k) {
    if (mean_radius_m(strip, first + (last - first) * k / steps_along) < unseen * narrowest) return true;
  }
  return false;
}

Result<Surface> strip_of_length(const Surface& before, const Surface& after, const BridgeLength& length,
                                int continuity) {
  const double start = before.v.domain_end() + length.parameter;
  const double of_after = after.v.domain_end() - after.v.domain_start();
  const auto moved = with_domain(after, Direction::v, start, start + length.stretch_of_after * of_after);
  if (!moved) return moved.error();
  return bridge(before, moved.value(), continuity);
}

// The gap crossed at the speed that the patches have at its edges.
Result<BridgeLength> at_even_speed(const Surface& before, const Surface& after) {
  double chord = 0.0, speed_before = 0.0, speed_after = 0.0;
  const std::vector<double> along = uniform_parameters_without_seam(before.u, 64);
  for (const double u : along) {
    const SurfacePoint a = evaluate(before, u, before.v.domain_end());
    const SurfacePoint b = evaluate(after, u, after.v.domain_start());
    chord += (a.position_m - b.position_m).norm() / static_cast<double>(along.size());
    speed_before += a.dv.norm() / static_cast<double>(along.size());
    speed_after += b.dv.norm() / static_cast<double>(along.size());
  }
  if (!(speed_before > 0.0) || !(speed_after > 0.0)) {
    return Error{"a patch has no direction at the edge to bridge from; cut a piece off there"};
  }
  return BridgeLength{chord / speed_before, speed_after / speed_before, chord};
}

// How a strip leads from ring to ring: with columns of its own between those that go on from the patches,
// where it has to bend, or is so long that what is uneven at the patches' ends would grow along it into
// folds.
struct BridgeForm {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // of the ring after towards that before
  bool bends = false, has_columns_between = false;
};

BridgeForm form_between(const Surface& before, const Surface& after) {
  if (!before.u.is_periodic()) return {};
  const RingPlace a = ring_place(before, Side::v_end), b = ring_place(after, Side::v_start);
  const Eigen::Matrix3d turn = turn_towards(a, b);
  constexpr double long_share = 2.0;  // of both radii
  const bool bends = is_bend(turn);
  const bool is_long = (b.centre_m - a.centre_m).norm() > long_share * (a.radius_m + b.radius_m);
  const bool leads = !a.outward.isZero() && !b.outward.isZero();
  return {turn, bends, bends || (is_long && leads)};
}

}  // namespace

Result<BridgeLength> bridge_length(const Surface& before, const Surface& after, int continuity,
                                   bool may_fold) {
  SPOONBILL_ASSERT(continuity >= 0);
  SPOONBILL_ASSERT(before.u.is_periodic() == after.u.is_periodic());
  auto even = at_even_speed(before, after);
  if (!even) return even.error();
  BridgeLength length = even.value();
  const BridgeForm form = form_between(before, after);
  if (form.bends) length.parameter *= bend_stretch(form.turn);
  for (int attempt = 0; attempt <= most_tightenings; ++attempt) {
    const auto strip = strip_of_length(before, after, length, continuity);
    if (!strip) return strip.error();
    const bool folds =
        !may_fold && place_of_fold_between(strip.value(), strip->v.domain_start(), strip->v.domain_end());
    const bool waisted = before.u.is_periodic() && !form.has_columns_between &&
                         attempt < tightenings_for_waist && has_waist(strip.value());
    if (!folds && !waisted) return length;
    length.parameter *= tightening;
  }
  return Error{"the gap of " + short_length_text(length.chord_m) +
               " cannot be bridged without a fold: its edges run into each other, or their parameters lie "
               "askew; cut a piece off, or allow a larger tolerance"};
}

Result<Surface> bridge(const Surface& before, const Surface& after, int continuity) {
  SPOONBILL_ASSERT(continuity >= 0);
  SPOONBILL_ASSERT(before.u.control_point_count() == after.u.control_point_count() &&
                   before.v.degree() == after.v.degree());
  const int degree = before.v.degree();
  // More continuity than asked where the degree gives it without further pieces.
  const int order = std::max(continuity, degree / 2);
  const BridgeForm form = form_between(before, after);
  const int between = form.has_columns_between ? columns_between : 0;
  const int count = std::max(2 * (order + 1), degree + 1) + between;
  auto knots = strip_knots(degree, count, before.v.domain_end(), after.v.domain_start());
  if (!knots) return Error{"the gap to bridge has no length; merge without a bridge"};
  ControlNet net(before.net.rows, count);
  for (int j = 0; j <= order; ++j) {
    continue_into(before, true, knots.value(), j, net);
    continue_into(after, false, knots.value(), count - 1 - j, net);
  }
  if (between > 0) fill_bend(net, order, count - 1 - order, outward(before, Side::v_end), form.turn);
  return make_surface(before.u, std::move(knots).value(), std::move(net));
}

}  // namespace spoonbill
