#include "engine/shapes/shape_sizes.h"

#include <string>

#include "engine/base/number_text.h"

namespace spoonbill {

namespace {

// Sizes that were asked for in millimetres come back from metres with a last digit of their own.
constexpr double slack = 1e-9;

}  // namespace

Status check_length(std::string_view name, double length_m, Range<double> range_m) {
  const Range<double> with_slack{range_m.low * (1.0 - slack), range_m.high * (1.0 + slack)};
  if (with_slack.contains(length_m)) return {};
  return Error{std::string(name) + " is " + length_text(length_m) + ", must be " + length_text(range_m.low) +
               " to " + length_text(range_m.high)};
}

Status check_size(std::string_view name, double size_m) {
  return check_length(name, size_m, shape_size_range_m);
}

Status check_rounding(std::string_view name, double rounding_m, double side_m, double most_m) {
  return check_length(name, rounding_m, {least_rounding_share * side_m, most_m});
}

}  // namespace spoonbill
