// A described number as the panel shows it with its unit, on a slider or typed in.
#pragma once

#include <string>

#include "engine/base/field.h"
#include "engine/base/result.h"

namespace spoonbill {

// As the slider shows it: "1.20 MPa", "0.45", "4.0 /s".
std::string quantity_text(const FieldForm& form, double value);

// What was typed, in SI: a number and a unit, or a number alone, which has the unit that `shown`, the text it
// replaces, ends in. Refused, with the units or the range in the message: another unit, no number, a value
// outside the range of the field.
Result<double> read_quantity(const FieldForm& form, const std::string& typed, const std::string& shown);

}  // namespace spoonbill
