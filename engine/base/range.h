// A closed range of a quantity, and the one line that says when a value lies outside it. The ranges stand
// beside the structs whose fields they bound, so that files, commands and the panel's sliders all use the
// same.
#pragma once

#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

template <class Number>
struct Range {
  Number low;
  Number high;

  // False for NaN.
  constexpr bool contains(Number value) const { return value >= low && value <= high; }
};

// "field is 12, must be 1 to 9". NaN and infinities are outside every range.
Status check_range(std::string_view field, double value, Range<double> range);
Status check_range(std::string_view field, int value, Range<int> range);

}  // namespace spoonbill
