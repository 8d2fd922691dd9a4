#include "engine/bspline/knot_vector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

std::optional<Error> degree_error(int degree) {
  if (degree >= 1 && degree <= max_degree) return std::nullopt;
  return Error{"degree " + std::to_string(degree) + " is outside 1 to " + std::to_string(max_degree) +
               "; choose a degree in that range"};
}

std::optional<Error> knot_error(const std::vector<double>& knots) {
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i])) {
      return Error{"knot " + std::to_string(i) + " (" + number_text(knots[i]) +
                   ") is not a finite number; replace it"};
    }
    if (i > 0 && knots[i] < knots[i - 1]) {
      return Error{"knot " + std::to_string(i) + " (" + number_text(knots[i]) + ") is smaller than knot " +
                   std::to_string(i - 1) + " (" + number_text(knots[i - 1]) + "); knots must not decrease"};
    }
  }
  return std::nullopt;
}

std::optional<Error> domain_error(double start, double end) {
  if (start < end && std::isfinite(end - start)) return std::nullopt;
  return Error{"the domain from knot " + number_text(start) + " to knot " + number_text(end) + " is " +
               (start < end ? "too long" : "empty") + "; spread the knots over a domain such as 0 to 1"};
}

Error multiplicity_error(double knot, int multiplicity, int allowed, const char* where) {
  return Error{"knot " + number_text(knot) + " appears " + std::to_string(multiplicity) + " times " + where +
               "; at most " + std::to_string(allowed) + " are allowed, remove " +
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

// Built from differences to the seam, so that knots that coincide at one end of the period coincide to the
// last bit at the other, and no rounding makes the sequence decrease.
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
    if (wraps < 0) {
      extended.push_back(start - (end - knot) + (wraps + 1) * period);
    } else if (wraps > 0) {
      extended.push_back(end + (knot - start) + (wraps - 1) * period);
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
    return Error{std::to_string(knots.size()) + " knots are too few for an open direction of degree " +
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
    return Error{std::to_string(knots.size()) +
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
    return Error{std::to_string(control_point_count) + " control points are too few for degree " +
                 std::to_string(degree) + "; use at least " + std::to_string(degree + 1)};
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
    return Error{std::to_string(control_point_count) +
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
  if (u == end) return start;  // which the rounded period may miss
  const double period = end - start;
  const double wrapped = u - period * std::floor((u - start) / period);
  return wrapped >= start && wrapped < end ? wrapped : start;
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

}  // namespace spoonbill
