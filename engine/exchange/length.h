// Lengths between metres in the program and millimetres in files, without losing a bit.
#pragma once

#include <optional>

#include "engine/exchange/json.h"

namespace spoonbill {

// The shortest number of millimetres whose thousandth is `metres` to the last bit. About one length in fifty
// has no such double (a binade holds more metres than millimetres); it becomes a decimal in quotes instead.
// Lengths that a person would write in millimetres are always plain numbers.
Json length_to_json(double metres);

// Metres, from a number of millimetres or a decimal in quotes; nothing for any other value.
std::optional<double> length_from_json(const Json& millimetres);

}  // namespace spoonbill
