#include "engine/bspline/reparameterise.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace spoonbill {

namespace {

Surface with_knots(const Surface& surface, Direction direction, KnotVector knots, ControlNet net) {
  return direction == Direction::u ? Surface{std::move(knots), surface.v, std::move(net)}
                                   : Surface{surface.u, std::move(knots), std::move(net)};
}

// Line i of the result is line from(i) of the net.
template <class From>
ControlNet reordered(const ControlNet& net, Direction direction, const From& from) {
  ControlNet result(net.rows, net.columns);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      result.set_point(i, j, direction == Direction::u ? net.point(from(i), j) : net.point(i, from(j)));
    }
  }
  return result;
}

// Of the knots of one period, the first that is not before `seam`.
int knot_at(const KnotVector& knots, double seam) {
  const auto& all = knots.knots();
  return static_cast<int>(std::lower_bound(all.begin(), all.end() - 1, seam) - all.begin());
}

Result<KnotVector> rotated(const KnotVector& knots, int first) {
  const auto& all = knots.knots();
  const int count = knots.control_point_count();
  const double start = all.front(), end = all.back();
  std::vector<double> turned;
  for (int i = 0; i < count; ++i) {
    const int from = (first + i) % count;
    const bool wrapped = first + i >= count;
    // The seam's first knot stands at the domain's start to the last bit.
    turned.push_back(wrapped ? (all[from] - start) + (end - all[first]) + start
                             : start + (all[from] - all[first]));
  }
  turned.push_back(end);
  return KnotVector::periodic(knots.degree(), std::move(turned));
}

}  // namespace

Surface reversed(const Surface& surface, Direction direction) {
  const KnotVector& knots = knots_along(surface, direction);
  const int count = knots.control_point_count(), degree = knots.degree();
  const auto from = [&](int i) {
    // A basis function starts at its knot and ends degree + 1 knots later; in a period that decides which
    // one it becomes.
    return knots.is_periodic() ? ((count - 1 - degree - i) % count + count) % count : count - 1 - i;
  };
  return with_knots(surface, direction, reversed(knots), reordered(surface.net, direction, from));
}

Surface exchanged(const Surface& surface) {
  ControlNet net(surface.net.columns, surface.net.rows);
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, surface.net.point(j, i));
  }
  return {surface.v, surface.u, std::move(net)};
}

Result<Surface> with_domain(const Surface& surface, Direction direction, double start, double end) {
  auto knots = with_domain(knots_along(surface, direction), start, end);
  if (!knots) return knots.error();
  return with_knots(surface, direction, std::move(knots).value(), surface.net);
}

Result<Surface> with_seam_at(const Surface& surface, Direction direction, double seam) {
  const KnotVector& knots = knots_along(surface, direction);
  if (!knots.is_periodic() || !std::isfinite(seam)) {
    return Error{"only a periodic direction has a seam to move, to a finite parameter"};
  }
  const double length = knots.domain_end() - knots.domain_start();
  double at = knots.into_domain(seam);
  for (const double knot : knots.breakpoints()) {
    if (std::abs(knot - at) <= same_knot_share * length) at = knots.into_domain(knot);
  }
  auto cut = insert_knot(surface, direction, at, 1);
  if (!cut) return cut.error();
  const KnotVector& finer = knots_along(cut.value(), direction);
  const int first = knot_at(finer, at), count = finer.control_point_count();
  if (first % count == 0) return cut;
  auto turned = rotated(finer, first);
  if (!turned) return turned.error();
  return with_knots(cut.value(), direction, std::move(turned).value(),
                    reordered(cut->net, direction, [&](int i) { return (first + i) % count; }));
}

Result<Surface> part_of(const Surface& surface, Direction direction, double start, double end) {
  const auto part = clamped_part(knots_along(surface, direction), start, end);
  if (!part) return part.error();
  return over_finer_knots(surface, direction, part.value());
}

}  // namespace spoonbill
