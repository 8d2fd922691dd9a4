// Parsing and printing of JSON: strict input, stable output, no exceptions.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

// JSON value that preserves the order of fields, so that reading and writing give the same bytes.
using Json = nlohmann::ordered_json;

// Parses JSON text. `source` names the file in messages, which give line and column. Besides syntax errors,
// these are refused: NaN and infinities, numbers beyond a double, a field that occurs twice, nesting deeper
// than 64, more than six million values, more than 1,000 fields in one object, a zero byte.
Result<Json> parse_json(std::string_view text, const std::string& source);

// Returns the value on one line, without spaces. Bytes that are not UTF-8 are replaced.
std::string json_to_line(const Json& json);

// Returns the value laid out for people and ending with a newline: a value that fits into 110 columns is on
// one line. Any other value has a line for each item, indented by two spaces per level.
std::string json_to_page(const Json& json);

// Converts a number to JSON, whole numbers without a fraction ("8", not "8.0"). A number that is not finite
// is written as null, which every reader refuses.
Json number_to_json(double number);

// Converts a length from metres to the shortest number of millimetres that, divided by 1000, gives `metres`
// to the last bit. About one length in fifty has no such double, because doubles of millimetres can be up to
// 2.4 % sparser than those of metres; such a length becomes a decimal in quotes. Lengths that a person would
// write in millimetres are always plain numbers.
Json length_to_json(double metres);

// Converts millimetres, given as a number or as a decimal in quotes, to metres; nullopt for any other value.
std::optional<double> length_from_json(const Json& millimetres);

// Returns a value as messages show it. A list is given by its length, an object only as "an object". Any
// other value is printed, cut with "..." after 40 characters.
std::string json_excerpt(const Json& json);

}  // namespace spoonbill
