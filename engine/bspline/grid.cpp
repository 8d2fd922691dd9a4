#include "engine/bspline/grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

Status check_parameters(const KnotVector& knots, const std::vector<double>& parameters) {
  if (parameters.size() < 2) {
    return Error{std::to_string(parameters.size()) + " parameters are too few; give at least 2"};
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string here = "parameter " + std::to_string(i) + " (" + number_text(parameters[i]) + ")";
    if (!(parameters[i] >= knots.domain_start() && parameters[i] <= knots.domain_end())) {
      return Error{here + " lies outside the domain " + number_text(knots.domain_start()) + " to " +
                   number_text(knots.domain_end()) + "; keep parameters inside"};
    }
    if (i > 0 && !(parameters[i] > parameters[i - 1])) {
      return Error{here + " is not greater than parameter " + std::to_string(i - 1) + " (" +
                   number_text(parameters[i - 1]) + "); parameters must increase"};
    }
  }
  return {};
}

GridDirection make_direction(const KnotVector& knots, std::vector<double> parameters) {
  BlendingMatrix values = blending_matrix(knots, parameters, 0);
  BlendingMatrix first = blending_matrix(knots, parameters, 1);
  BlendingMatrix second = blending_matrix(knots, parameters, 2);
  return {knots, std::move(parameters), std::move(values), std::move(first), std::move(second)};
}

// Exact at both ends, which start + length need not be.
double between(double start, double end, int i, int count) {
  return i >= count ? end : start + (end - start) * i / count;
}

}  // namespace

Result<Grid> make_grid(const KnotVector& u, const KnotVector& v, std::vector<double> u_parameters,
                       std::vector<double> v_parameters) {
  if (const Status status = check_parameters(u, u_parameters); !status) {
    return Error{"direction u: " + status.error().message};
  }
  if (const Status status = check_parameters(v, v_parameters); !status) {
    return Error{"direction v: " + status.error().message};
  }
  return Grid{make_direction(u, std::move(u_parameters)), make_direction(v, std::move(v_parameters))};
}

std::vector<double> uniform_parameters(const KnotVector& knots, int count) {
  SPOONBILL_ASSERT(count >= 0);
  std::vector<double> parameters;
  parameters.reserve(static_cast<std::size_t>(std::max(count, 0)));
  for (int i = 0; i < count; ++i) {
    parameters.push_back(between(knots.domain_start(), knots.domain_end(), i, count - 1));
  }
  return parameters;
}

std::vector<double> uniform_parameters_without_seam(const KnotVector& knots, int count) {
  SPOONBILL_ASSERT(count >= 0);
  std::vector<double> parameters;
  parameters.reserve(static_cast<std::size_t>(std::max(count, 0)));
  for (int i = 0; i < count; ++i) {
    parameters.push_back(between(knots.domain_start(), knots.domain_end(), i, count));
  }
  return parameters;
}

NestedParameters nested_parameters(const KnotVector& knots, int pieces_per_span, int levels) {
  SPOONBILL_ASSERT(pieces_per_span >= 1);
  SPOONBILL_ASSERT(levels >= 0 && levels < 31);
  NestedParameters nested;
  nested.levels = levels;
  const std::vector<double> breaks = knots.breakpoints();
  const int pieces = pieces_per_span * (1 << levels);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    for (int i = 0; i < pieces; ++i) {
      nested.parameters.push_back(between(breaks[k], breaks[k + 1], i, pieces));
    }
  }
  nested.parameters.push_back(breaks.back());
  return nested;
}

}  // namespace spoonbill
