// JSON text to values and back: strict in, stable out. No exceptions for any input.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

// Keeps the order of fields, so that reading and writing give the same bytes.
using Json = nlohmann::ordered_json;

// JSON text to a value. `source` names the file in messages, which give line and column. Besides syntax
// errors refused: NaN and infinities, numbers beyond a double, a field given twice, nesting deeper than 64,
// more than two million values, more than 1,000 fields in one object.
Result<Json> parse_json(std::string_view text, const std::string& source);

// On one line, without spaces. Bytes that are not UTF-8 are replaced.
std::string json_to_line(const Json& json);

// For people: what fits stands on one line, the rest is indented by two; ends with a newline.
std::string json_to_page(const Json& json);

// Whole numbers without a fraction ("8", not "8.0"). What is not finite is written as null, which no reader
// takes.
Json number_to_json(double number);

// A value as messages show it: on one line and at most 40 characters.
std::string json_excerpt(const Json& json);

}  // namespace spoonbill
