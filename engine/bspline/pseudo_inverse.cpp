#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/number_text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/least_squares.h"

namespace spoonbill {

namespace {

std::vector<double> sorted_distinct(const KnotVector& knots, std::span<const double> parameters) {
  std::vector<double> sorted;
  for (const double parameter : parameters) sorted.push_back(knots.into_domain(parameter));
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

// The basis function that starts at extended knot i, at t: positive inside its support, and at a clamped end.
bool supports(const KnotVector& knots, int i, double t) {
  const auto& extended = knots.extended_knots();
  const double start = extended[i], end = extended[i + knots.degree() + 1];
  if (t > start && t < end) return true;
  return (t == start && extended[i + knots.degree()] == start && start < end) ||
         (t == end && extended[i + 1] == end && start < end);
}

Error gap_error(const KnotVector& knots, int control, double start, double end) {
  return Error{"control point " + std::to_string(control) + " of " +
               std::to_string(knots.control_point_count()) + " has no sample of its own between " +
               number_text(start) + " and " + number_text(end) + "; add samples there"};
}

Status check_open(const KnotVector& knots, const std::vector<double>& samples) {
  const auto& extended = knots.extended_knots();
  std::size_t next = 0;
  for (int i = 0; i < knots.control_point_count(); ++i) {
    const double end = extended[i + knots.degree() + 1];
    while (next < samples.size() && samples[next] < end && !supports(knots, i, samples[next])) ++next;
    if (next == samples.size() || !supports(knots, i, samples[next])) {
      return gap_error(knots, i, std::max(extended[i], knots.domain_start()),
                       std::min(end, knots.domain_end()));
    }
    ++next;
  }
  return {};
}

// Control points matched in cyclic order, when control point 0 takes sample `offset`; samples are numbered
// through the periods.
int matched_from(const KnotVector& knots, const std::vector<double>& samples, int offset) {
  const double period = knots.domain_end() - knots.domain_start();
  const int count = static_cast<int>(samples.size());
  const auto position = [&](int sample) {
    const int wraps = sample >= 0 ? sample / count : (sample - count + 1) / count;
    return samples[static_cast<std::size_t>(sample - wraps * count)] + wraps * period;
  };
  const auto& extended = knots.extended_knots();
  int next = offset;
  for (int i = 0; i < knots.control_point_count(); ++i) {
    const double start = extended[i + knots.degree()];
    const double end = extended[i + 2 * knots.degree() + 1];
    while (position(next) <= start) ++next;
    if (position(next) >= end || next >= offset + count) return i;
    ++next;
  }
  return knots.control_point_count();
}

Status check_periodic(const KnotVector& knots, const std::vector<double>& samples) {
  int matched = 0;
  for (int offset = 0; offset < static_cast<int>(samples.size()) && matched < knots.control_point_count();
       ++offset) {
    matched = std::max(matched, matched_from(knots, samples, offset));
  }
  if (matched == knots.control_point_count()) return {};
  const auto& knot = knots.knots();
  const int end = (matched + knots.degree() + 1) % knots.control_point_count();
  return gap_error(knots, matched, knot[matched], knot[end]);
}

}  // namespace

Status check_schoenberg_whitney(const KnotVector& knots, std::span<const double> parameters) {
  const std::vector<double> samples = sorted_distinct(knots, parameters);
  return knots.is_periodic() ? check_periodic(knots, samples) : check_open(knots, samples);
}

Result<Eigen::MatrixXd> pseudo_inverse(const KnotVector& knots, std::span<const double> parameters) {
  const int controls = knots.control_point_count();
  const std::string samples = std::to_string(parameters.size()) + " samples";
  const std::string remedy = "; take at least " + std::to_string(2 * controls) + ", evenly spread";
  if (parameters.size() < static_cast<std::size_t>(controls)) {
    return Error{samples + " are too few for " + std::to_string(controls) + " control points" + remedy};
  }
  if (Status status = check_schoenberg_whitney(knots, parameters); !status) return status.error();

  std::optional<Eigen::MatrixXd> inverse =
      least_squares_inverse(blending_matrix(knots, parameters, 0).dense());
  if (!inverse) {
    return Error{samples + " at these parameters do not determine the " + std::to_string(controls) +
                 " control points of degree " + std::to_string(knots.degree()) +
                 (knots.is_periodic() ? " in a periodic direction" : "") + remedy};
  }
  return *std::move(inverse);
}

}  // namespace spoonbill
