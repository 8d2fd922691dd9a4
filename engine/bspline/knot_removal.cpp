#include "engine/bspline/knot_removal.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

Error no_knot_at(double parameter, std::vector<KnotMultiplicity> all, bool periodic) {
  if (!periodic) all.erase(all.begin());
  if (all.empty()) return Error{"the direction is one polynomial piece and has no knot to take out"};
  const auto nearest = std::min_element(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.knot - parameter) < std::abs(b.knot - parameter);
  });
  return Error{"no knot stands at " + number_text(parameter) + "; the nearest is at " +
               number_text(nearest->knot)};
}

Result<KnotVector> fewer_knots(const KnotVector& knots, std::vector<KnotMultiplicity> all, std::size_t place,
                               int copies) {
  all[place].multiplicity -= copies;
  std::vector<double> fewer;
  for (const auto& [knot, multiplicity] : all) {
    fewer.insert(fewer.end(), static_cast<std::size_t>(multiplicity), knot);
  }
  if (knots.is_periodic()) {
    fewer.push_back(knots.domain_end());
    return KnotVector::periodic(knots.degree(), std::move(fewer));
  }
  fewer.insert(fewer.end(), static_cast<std::size_t>(knots.degree()) + 1, knots.domain_end());
  return KnotVector::open(knots.degree(), std::move(fewer));
}

}  // namespace

Result<Approximation> without_knot(const Surface& surface, Direction direction, double parameter,
                                   int copies) {
  SPOONBILL_ASSERT(copies >= 1);
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const KnotVector& knots = knots_along(surface, direction);
  const double near = same_knot_share * (knots.domain_end() - knots.domain_start());
  const double wanted = knots.is_periodic() && parameter >= knots.domain_end() - near
                            ? parameter - (knots.domain_end() - knots.domain_start())
                            : parameter;
  const std::vector<KnotMultiplicity> all = knot_multiplicities(knots);
  if (!knots.is_periodic()) {
    for (const double end : {knots.domain_start(), knots.domain_end()}) {
      if (std::abs(end - wanted) <= near) {
        return Error{number_text(end) + " is an end of the direction, whose knots stay; name one inside"};
      }
    }
  }
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const auto& one) { return std::abs(one.knot - wanted) <= near; });
  if (found == all.end()) return no_knot_at(parameter, all, knots.is_periodic());
  if (copies > found->multiplicity) {
    return Error{"the knot at " + number_text(found->knot) + " cannot be taken out " +
                 std::to_string(copies) + " times; it stands there " + std::to_string(found->multiplicity)};
  }
  const auto place = static_cast<std::size_t>(found - all.begin());
  if (knots.is_periodic() && place == 0 && copies == found->multiplicity) {
    return Error{"the seam takes a knot; begin the closed direction elsewhere first"};
  }
  const auto fewer = fewer_knots(knots, all, place, copies);
  if (!fewer) return fewer.error();
  return over_coarser_knots(surface, direction, fewer.value());
}

}  // namespace spoonbill
