// A quantity that the panel shows with its unit, on a slider or typed in.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/base/range.h"
#include "engine/base/result.h"

namespace spoonbill {

enum class SliderScale { linear, logarithmic };

// How many SI units one of it is; the name is empty for a pure number.
struct QuantityUnit {
  std::string_view name;
  double size = 1.0;
};

struct Quantity {
  const char* label;
  Range<double> slider;   // what a hand can tell apart, SI
  Range<double> allowed;  // what may be typed, SI
  SliderScale scale = SliderScale::linear;
  std::span<const QuantityUnit> units;
};

// What was typed, in SI: a number and a unit, or a number alone, which has the unit that `shown`, the text it
// replaces, ends in. Refused, with the units or the range in the message: another unit, no number, a value
// outside the range.
Result<double> read_quantity(const Quantity& quantity, const std::string& typed, const std::string& shown);

}  // namespace spoonbill
