#include "engine/merging/seam.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/merging/edge_match.h"

namespace spoonbill {

namespace {

constexpr int largest_count = 200;

double edge_gap_m(const Surface& surface, Direction direction) {
  const bool u = direction == Direction::u;
  const EdgeCurve first = edge_curve(surface, u ? Side::u_start : Side::v_start);
  const EdgeCurve last = edge_curve(surface, u ? Side::u_end : Side::v_end);
  double largest = 0.0;
  for (std::size_t k = 0; k < first.control_points_m.size(); ++k) {
    largest = std::max(largest, (first.control_points_m[k] - last.control_points_m[k]).norm());
  }
  return largest;
}

Result<KnotVector> period_of(const KnotVector& knots, int continuity) {
  const auto all = knot_multiplicities(knots);
  const int at_seam = std::max(1, knots.degree() - continuity);
  std::vector<double> period(static_cast<std::size_t>(at_seam), knots.domain_start());
  for (const auto& [knot, multiplicity] : all) {
    if (knot == knots.domain_start()) continue;
    period.insert(period.end(), static_cast<std::size_t>(multiplicity), knot);
  }
  // A period takes two control points at least.
  if (period.size() < 2) period.push_back(0.5 * (knots.domain_start() + knots.domain_end()));
  period.push_back(knots.domain_end());
  return KnotVector::periodic(knots.degree(), std::move(period));
}

}  // namespace

Result<Approximation> closed_around(const Surface& surface, Direction direction, int continuity,
                                    double tolerance_m, const Progress& progress) {
  SPOONBILL_ASSERT(continuity >= 0);
  const KnotVector& knots = knots_along(surface, direction);
  if (knots.is_periodic()) return Error{"the direction is closed already; choose the other one"};
  if (const double gap_m = edge_gap_m(surface, direction); gap_m > tolerance_m) {
    return Error{"the first and the last edge are " + short_length_text(gap_m) +
                 " apart; allow a larger tolerance or bring them together"};
  }
  const auto raised = elevate_degree(knots, std::max(knots.degree(), continuity + 1));
  if (!raised) return raised.error();
  const auto period = period_of(raised.value(), continuity);
  if (!period) return period.error();
  return approximated(surface, direction, period.value(), tolerance_m, largest_count, progress);
}

}  // namespace spoonbill
