#include "engine/base/range.h"

#include <string>

#include "engine/base/number_text.h"

namespace spoonbill {

Status check_range(std::string_view field, double value, Range<double> range) {
  if (range.contains(value)) return {};
  return Error{std::string(field) + " is " + number_text(value) + ", must be " + number_text(range.low) +
               " to " + number_text(range.high)};
}

Status check_range(std::string_view field, int value, Range<int> range) {
  if (range.contains(value)) return {};
  return Error{std::string(field) + " is " + std::to_string(value) + ", must be " +
               std::to_string(range.low) + " to " + std::to_string(range.high)};
}

}  // namespace spoonbill
