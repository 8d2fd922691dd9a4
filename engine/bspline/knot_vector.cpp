#include "engine/bspline/knot_vector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {

namespace {

std::optional<Error> degree_error(int degree) {
  if (degree >= 1 && degree <= max_degree) return std::nullopt;
  return Error{ErrorCode::out_of_range, "degree " + std::to_string(degree) + " is outside 1 to " +
                                            std::to_string(max_degree) + "; choose a degree in that range"};
}

std::optional<Error> knot_error(const std::vector<double>& knots) {
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i])) {
      return Error{ErrorCode::out_of_range, "knot " + std::to_string(i) + " (" + number_text(knots[i]) +
                                                ") is not a finite number; replace it"};
    }
    if (i > 0 && knots[i] < knots[i - 1]) {
      return Error{ErrorCode::malformed, "knot " + std::to_string(i) + " (" + number_text(knots[i]) +
                                             ") is smaller than knot " + std::to_string(i - 1) + " (" +
                                             number_text(knots[i - 1]) + "); knots must not decrease"};
    }
  }
  return std::nullopt;
}

std::optional<Error> domain_error(double start, double end) {
  if (start < end && std::isfinite(end - start)) return std::nullopt;
  return Error{ErrorCode::degenerate, "the domain from knot " + number_text(start) + " to knot " +
                                          number_text(end) + " is " + (start < end ? "too long" : "empty") +
                                          "; spread the knots over a domain such as 0 to 1"};
}

Error multiplicity_error(double knot, int multiplicity, int allowed, const char* where) {
  return Error{ErrorCode::malformed, "knot " + number_text(knot) + " appears " +
                                         std::to_string(multiplicity) + " times " + where + ", but at most " +
                                         std::to_string(allowed) + " are allowed; remove " +
                                         std::to_string(multiplicity - allowed)};
}

std::optional<Error> open_multiplicity_error(const std::vector<double>& knots, int degree, double start,
                                             double end) {
  for (std::size_t i = 0; i < knots.size();) {
    std::size_t next = i + 1;
    while (next < knots.size() && knots[next] == knots[i]) ++next;
    const int multiplicity = static_cast<int>(next - i);
    const bool inside = knots[i] > start && knots[i] < end;
    const int allowed = inside ? degree : degree + 1;
    if (multiplicity > allowed) {
      return multiplicity_error(knots[i], multiplicity, allowed,
                                inside ? "inside the domain" : "at an end of the domain");
    }
    i = next;
  }
  return std::nullopt;
}

std::optional<Error> periodic_multiplicity_error(const std::vector<double>& knots, int degree) {
  const auto count = [&](double knot) {
    return static_cast<int>(std::count(knots.begin(), knots.end(), knot));
  };
  const int at_seam = count(knots.front()) + count(knots.back()) - 1;
  if (at_seam > degree) return multiplicity_error(knots.front(), at_seam, degree, "at the periodic seam");
  for (const double knot : knots) {
    const int multiplicity = count(knot);
    if (multiplicity > degree) {
      return multiplicity_error(knot, multiplicity, degree, "inside the period");
    }
  }
  return std::nullopt;
}

// Extends the knots of one period on both sides. The new knots are computed from the differences between
// knots and the seam. Equal knots are then exactly equal in every period, also at the seam, and the sequence
// never decreases.
std::vector<double> extend_periodic(const std::vector<double>& knots, int degree) {
  const int r = static_cast<int>(knots.size()) - 1;
  const double start = knots.front(), end = knots.back(), period = end - start;
  std::vector<double> extended;
  extended.reserve(knots.size() + 2 * static_cast<std::size_t>(degree));
  for (int i = -degree; i <= r + degree; ++i) {
    int wraps = 0;
    int within = i;
    for (; within < 0; within += r) --wraps;
    for (; within > r; within -= r) ++wraps;
    const double knot = knots[static_cast<std::size_t>(within)];
    // Copies of the seam that belong to two periods are computed alike.
    if (wraps < 0) {
      extended.push_back(knot == start ? start + wraps * period
                                       : start - (end - knot) + (wraps + 1) * period);
    } else if (wraps > 0) {
      extended.push_back(knot == end ? end + wraps * period : end + (knot - start) + (wraps - 1) * period);
    } else {
      extended.push_back(knot);
    }
  }
  return extended;
}

}  // namespace

Result<KnotVector> KnotVector::open(int degree, std::vector<double> knots) {
  if (auto error = degree_error(degree)) return *std::move(error);
  const int count = static_cast<int>(knots.size()) - degree - 1;
  if (count < degree + 1) {
    return Error{ErrorCode::too_few,
                 std::to_string(knots.size()) + " knots are too few for an open direction of degree " +
                     std::to_string(degree) + "; give at least " + std::to_string(2 * degree + 2) +
                     " knots for " + std::to_string(degree + 1) + " control points"};
  }
  if (auto error = knot_error(knots)) return *std::move(error);
  const double start = knots[static_cast<std::size_t>(degree)], end = knots[static_cast<std::size_t>(count)];
  if (auto error = domain_error(start, end)) return *std::move(error);
  if (auto error = open_multiplicity_error(knots, degree, start, end)) return *std::move(error);

  KnotVector result;
  result.degree_ = degree;
  result.control_point_count_ = count;
  result.extended_ = knots;
  result.knots_ = std::move(knots);
  return result;
}

Result<KnotVector> KnotVector::periodic(int degree, std::vector<double> knots) {
  if (auto error = degree_error(degree)) return *std::move(error);
  if (knots.size() < 3) {
    return Error{
        ErrorCode::too_few,
        std::to_string(knots.size()) +
            " knots are too few for a periodic direction; give at least 3 knots for 2 control points"};
  }
  if (auto error = knot_error(knots)) return *std::move(error);
  if (auto error = domain_error(knots.front(), knots.back())) return *std::move(error);
  if (auto error = periodic_multiplicity_error(knots, degree)) return *std::move(error);

  KnotVector result;
  result.degree_ = degree;
  result.control_point_count_ = static_cast<int>(knots.size()) - 1;
  result.periodic_ = true;
  result.extended_ = extend_periodic(knots, degree);
  result.knots_ = std::move(knots);
  return result;
}

Result<KnotVector> KnotVector::clamped_uniform(int degree, int control_point_count) {
  if (auto error = degree_error(degree)) return *std::move(error);
  if (control_point_count < degree + 1) {
    return Error{ErrorCode::too_few, std::to_string(control_point_count) +
                                         " control points are too few for degree " + std::to_string(degree) +
                                         "; use at least " + std::to_string(degree + 1)};
  }
  const int spans = control_point_count - degree;
  std::vector<double> knots;
  knots.insert(knots.end(), static_cast<std::size_t>(degree), 0.0);
  for (int i = 0; i <= spans; ++i) knots.push_back(static_cast<double>(i) / spans);
  knots.insert(knots.end(), static_cast<std::size_t>(degree), 1.0);
  return open(degree, std::move(knots));
}

Result<KnotVector> KnotVector::periodic_uniform(int degree, int control_point_count) {
  if (auto error = degree_error(degree)) return *std::move(error);
  if (control_point_count < 2) {
    return Error{ErrorCode::too_few,
                 std::to_string(control_point_count) +
                     " control points are too few for a periodic direction; use at least 2"};
  }
  std::vector<double> knots;
  for (int i = 0; i <= control_point_count; ++i) {
    knots.push_back(static_cast<double>(i) / control_point_count);
  }
  return periodic(degree, std::move(knots));
}

std::vector<double> KnotVector::breakpoints() const {
  SPOONBILL_ASSERT(control_point_count_ > 0);
  std::vector<double> distinct(extended_.begin() + degree_, extended_.end() - degree_);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  return distinct;
}

double KnotVector::into_domain(double u) const {
  SPOONBILL_ASSERT_DEBUG(control_point_count_ > 0);
  const double start = domain_start(), end = domain_end();
  if (!periodic_) return u > start ? std::min(u, end) : start;
  if (u >= start && u < end) return u;
  if (u == end) return start;  // subtracting the period, which is rounded, may give a value beside the start
  const double period = end - start;
  const double wrapped = u - period * std::floor((u - start) / period);
  return wrapped >= start && wrapped < end ? wrapped : start;
}

void KnotVector::reserve(int control_points) {
  const auto most = static_cast<std::size_t>(control_points + 2 * max_degree + 1);
  knots_.reserve(most);
  extended_.reserve(most);
}

int KnotVector::find_span(double u) const {
  SPOONBILL_ASSERT_DEBUG(u >= domain_start() && u <= domain_end());
  const auto first = extended_.begin() + degree_, last = extended_.end() - 1 - degree_;
  const auto after = u < *last ? std::upper_bound(first, last, u) : std::lower_bound(first, last, *last);
  return static_cast<int>(after - extended_.begin()) - 1;
}

int KnotVector::control_index(int span, int j) const {
  SPOONBILL_ASSERT_DEBUG(j >= 0 && j <= degree_);
  if (!periodic_) {
    SPOONBILL_ASSERT_DEBUG(span - degree_ + j >= 0 && span - degree_ + j < control_point_count_);
    return span - degree_ + j;
  }
  const int index = (span - 2 * degree_ + j) % control_point_count_;
  return index < 0 ? index + control_point_count_ : index;
}

namespace {

bool same_knot(double a, double b, double length) {
  return std::abs(a - b) <= same_knot_fraction * length;
}

// Assembles a knot vector from unsorted multiplicities, which do not include the end of the domain. In an
// open direction the start must have the multiplicity degree + 1, and the end is added with the same
// multiplicity.
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

Result<KnotVector> change_degree(const KnotVector& knots, int degree) {
  std::vector<KnotMultiplicity> all = knot_multiplicities(knots);
  for (auto& [knot, multiplicity] : all) {
    multiplicity = std::clamp(multiplicity + degree - knots.degree(), 1, std::max(degree, 1));
  }
  if (!knots.is_periodic()) all.front().multiplicity = degree + 1;
  return assemble(degree, knots.is_periodic(), all, knots.domain_end());
}

Error degree_error(int degree, const KnotVector& knots, const char* wanted) {
  return Error{ErrorCode::out_of_range, "degree " + std::to_string(degree) + " must be " + wanted +
                                            " the present degree " + std::to_string(knots.degree()) +
                                            "; choose another"};
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

Result<KnotVector> elevate_degree(const KnotVector& knots, int degree) {
  if (degree < knots.degree() || degree > max_degree) {
    return degree_error(degree, knots, "from 1 to 9 and at least");
  }
  return change_degree(knots, degree);
}

Result<KnotVector> reduce_degree(const KnotVector& knots, int degree) {
  if (degree < 1 || degree > knots.degree()) return degree_error(degree, knots, "at least 1 and at most");
  return change_degree(knots, degree);
}

Result<KnotVector> knot_union(const KnotVector& a, const KnotVector& b) {
  const double length = a.domain_length();
  if (a.degree() != b.degree() || a.is_periodic() != b.is_periodic() ||
      !same_knot(a.domain_start(), b.domain_start(), length) ||
      !same_knot(a.domain_end(), b.domain_end(), length)) {
    return Error{
        ErrorCode::mismatch,
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

std::vector<double> knot_positions_from(const KnotVector& knots, double knot, double start) {
  if (!knots.is_periodic()) return {knot};
  const double length = knots.domain_length();
  const double first = knot + std::ceil((start - knot) / length) * length;
  return {first, first + length};
}

Result<KnotVector> clamped_part(const KnotVector& knots, double start, double end) {
  const double length = knots.domain_length();
  const bool within = knots.is_periodic()
                          ? std::isfinite(start) && end - start <= (1.0 + same_knot_fraction) * length
                          : start >= knots.domain_start() && end <= knots.domain_end();
  if (!within || !(end - start > same_knot_fraction * length)) {
    return Error{ErrorCode::out_of_range, "the part from " + number_text(start) + " to " + number_text(end) +
                                              " is empty or not within the domain " +
                                              number_text(knots.domain_start()) + " to " +
                                              number_text(knots.domain_end()) + "; choose another"};
  }
  std::vector<KnotMultiplicity> all{{start, knots.degree() + 1}};
  for (const auto& inner : knot_multiplicities(knots)) {
    for (const double knot : knot_positions_from(knots, inner.knot, start)) {
      if (knot > start && knot < end && !same_knot(knot, start, length) && !same_knot(knot, end, length)) {
        all.push_back({knot, inner.multiplicity});
      }
    }
  }
  return assemble(knots.degree(), false, all, end);
}

Result<KnotVector> with_domain(const KnotVector& knots, double start, double end) {
  if (!(start < end) || !std::isfinite(end - start)) {
    return Error{ErrorCode::out_of_range, "the domain from " + number_text(start) + " to " +
                                              number_text(end) +
                                              " is empty or not finite; give two increasing numbers"};
  }
  const double from = knots.domain_start(), to = knots.domain_end();
  if (start == from && end == to) return knots;
  std::vector<double> all = knots.knots();
  for (double& knot : all) {
    // The last knot must be exactly `end`, without rounding.
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

Result<KnotVector> halve_pieces(const KnotVector& knots, const std::vector<double>& where) {
  const std::vector<double> ends = knots.breakpoints();
  std::vector<double> all = knots.knots();
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const double start = ends[piece], end = ends[piece + 1];
    const bool chosen = std::any_of(where.begin(), where.end(), [&](double u) {
      const double inside = knots.into_domain(u);
      return inside >= start && inside <= end;
    });
    if (chosen && end - start > 1e-6 * knots.domain_length()) all.push_back(0.5 * (start + end));
  }
  std::sort(all.begin(), all.end());
  return knots.is_periodic() ? KnotVector::periodic(knots.degree(), std::move(all))
                             : KnotVector::open(knots.degree(), std::move(all));
}

}  // namespace spoonbill
