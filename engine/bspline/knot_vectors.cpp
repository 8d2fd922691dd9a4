#include "engine/bspline/knot_vectors.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

double length_of(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

bool same_knot(double a, double b, double length) {
  return std::abs(a - b) <= same_knot_share * length;
}

// `all` need not be sorted, and holds an open start degree + 1 times; an open end is added as often.
Result<KnotVector> assemble(int degree, bool periodic, const std::vector<KnotMultiplicity>& all, double end) {
  std::vector<double> knots;
  for (const auto& [knot, multiplicity] : all) {
    knots.insert(knots.end(), static_cast<std::size_t>(multiplicity), knot);
  }
  std::sort(knots.begin(), knots.end());
  if (periodic) {
    knots.push_back(end);
    return KnotVector::periodic(degree, std::move(knots));
  }
  knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, end);
  return KnotVector::open(degree, std::move(knots));
}

int seam_multiplicity(const KnotVector& knots) {
  const auto& all = knots.knots();
  return static_cast<int>(std::count(all.begin(), all.end(), all.front()) +
                          std::count(all.begin(), all.end(), all.back())) -
         1;
}

Result<KnotVector> with_degree(const KnotVector& knots, int degree) {
  std::vector<KnotMultiplicity> all = knot_multiplicities(knots);
  for (auto& [knot, multiplicity] : all) {
    multiplicity = std::clamp(multiplicity + degree - knots.degree(), 1, std::max(degree, 1));
  }
  if (!knots.is_periodic()) all.front().multiplicity = degree + 1;
  return assemble(degree, knots.is_periodic(), all, knots.domain_end());
}

Error degree_error(int degree, const KnotVector& knots, const char* wanted) {
  return Error{"degree " + std::to_string(degree) + " is not " + wanted + " the present degree " +
               std::to_string(knots.degree()) + "; choose another"};
}

}  // namespace

std::vector<KnotMultiplicity> knot_multiplicities(const KnotVector& knots) {
  const auto& all = knots.knots();
  std::vector<KnotMultiplicity> counted;
  for (const double knot : knots.breakpoints()) {
    counted.push_back({knot, static_cast<int>(std::count(all.begin(), all.end(), knot))});
  }
  counted.pop_back();
  counted.front().multiplicity = knots.is_periodic() ? seam_multiplicity(knots) : knots.degree() + 1;
  return counted;
}

Result<KnotVector> elevated(const KnotVector& knots, int degree) {
  if (degree < knots.degree() || degree > max_degree) {
    return degree_error(degree, knots, "from 1 to 9 and at least");
  }
  return with_degree(knots, degree);
}

Result<KnotVector> reduced(const KnotVector& knots, int degree) {
  if (degree < 1 || degree > knots.degree()) return degree_error(degree, knots, "from 1 to at most");
  return with_degree(knots, degree);
}

Result<KnotVector> knot_union(const KnotVector& a, const KnotVector& b) {
  const double length = length_of(a);
  if (a.degree() != b.degree() || a.is_periodic() != b.is_periodic() ||
      !same_knot(a.domain_start(), b.domain_start(), length) ||
      !same_knot(a.domain_end(), b.domain_end(), length)) {
    return Error{
        "knot vectors of different degrees, periodicity or domains have no union; match these first"};
  }
  std::vector<KnotMultiplicity> all = knot_multiplicities(a);
  for (const auto& more : knot_multiplicities(b)) {
    const auto same = std::find_if(all.begin(), all.end(),
                                   [&](const auto& k) { return same_knot(k.knot, more.knot, length); });
    if (same == all.end()) {
      all.push_back(more);
    } else {
      same->multiplicity = std::max(same->multiplicity, more.multiplicity);
    }
  }
  return assemble(a.degree(), a.is_periodic(), all, a.domain_end());
}

std::vector<double> places_from(const KnotVector& knots, double knot, double start) {
  if (!knots.is_periodic()) return {knot};
  const double length = length_of(knots);
  const double first = knot + std::ceil((start - knot) / length) * length;
  return {first, first + length};
}

Result<KnotVector> clamped_part(const KnotVector& knots, double start, double end) {
  const double length = length_of(knots);
  const bool within = knots.is_periodic()
                          ? std::isfinite(start) && end - start <= (1.0 + same_knot_share) * length
                          : start >= knots.domain_start() && end <= knots.domain_end();
  if (!within || !(end - start > same_knot_share * length)) {
    return Error{"the part from " + number_text(start) + " to " + number_text(end) +
                 " is empty or not within the domain " + number_text(knots.domain_start()) + " to " +
                 number_text(knots.domain_end()) + "; choose another"};
  }
  std::vector<KnotMultiplicity> all{{start, knots.degree() + 1}};
  for (const auto& inner : knot_multiplicities(knots)) {
    for (const double knot : places_from(knots, inner.knot, start)) {
      if (knot > start && knot < end && !same_knot(knot, start, length) && !same_knot(knot, end, length)) {
        all.push_back({knot, inner.multiplicity});
      }
    }
  }
  return assemble(knots.degree(), false, all, end);
}

Result<KnotVector> with_domain(const KnotVector& knots, double start, double end) {
  if (!(start < end) || !std::isfinite(end - start)) {
    return Error{"the domain from " + number_text(start) + " to " + number_text(end) +
                 " is empty or not finite; give two increasing numbers"};
  }
  const double from = knots.domain_start(), to = knots.domain_end();
  if (start == from && end == to) return knots;
  std::vector<double> all = knots.knots();
  for (double& knot : all) {
    // Both ends to the last bit.
    knot = knot == to ? end : start + (knot - from) / (to - from) * (end - start);
  }
  return knots.is_periodic() ? KnotVector::periodic(knots.degree(), std::move(all))
                             : KnotVector::open(knots.degree(), std::move(all));
}

KnotVector reversed(const KnotVector& knots) {
  const double start = knots.domain_start(), end = knots.domain_end();
  std::vector<double> all(knots.knots().rbegin(), knots.knots().rend());
  for (double& knot : all) knot = knot == end ? start : knot == start ? end : start + (end - knot);
  return knots.is_periodic() ? KnotVector::periodic(knots.degree(), std::move(all)).value()
                             : KnotVector::open(knots.degree(), std::move(all)).value();
}

Result<KnotVector> with_pieces_halved(const KnotVector& knots, const std::vector<double>& where) {
  const std::vector<double> ends = knots.breakpoints();
  std::vector<double> all = knots.knots();
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const double start = ends[piece], end = ends[piece + 1];
    const bool asked = std::any_of(where.begin(), where.end(), [&](double u) {
      const double inside = knots.into_domain(u);
      return inside >= start && inside <= end;
    });
    if (asked && end - start > 1e-6 * length_of(knots)) all.push_back(0.5 * (start + end));
  }
  std::sort(all.begin(), all.end());
  return knots.is_periodic() ? KnotVector::periodic(knots.degree(), std::move(all))
                             : KnotVector::open(knots.degree(), std::move(all));
}

}  // namespace spoonbill
