// Text of numbers, lengths, points and quotations in messages and reports.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/geometry.h"

namespace spoonbill {

// Returns the shortest decimal text that parses to the same number.
std::string number_text(double number);

// Returns metres as millimetres with at most `digits` significant digits, such as "2.5 mm"; zero has no sign.
std::string millimetres_with_digits(double length_m, int digits);

// Returns metres as millimetres with at most three significant digits.
std::string short_length_text(double length_m);

// Returns metres as millimetres with at most twelve significant digits, which hides the rounding error of the
// conversion: 0.009 m is 9.000000000000002 mm in binary arithmetic.
std::string length_text(double length_m);

// Returns a point in millimetres with one decimal, such as "(10.0, -5.2, 0.0) mm"; zeros have no sign.
std::string position_text(const Vector3& point_m);

// Returns the text with dangerous characters in JSON's escaped form, such as "\u001b". Dangerous characters
// could control a terminal, break a line or reorder the text on the screen: control characters (U+0000 to
// U+001F, U+007F to U+009F), direction marks and line separators. Names in files can contain all of these. A
// byte that is not UTF-8 becomes "\u00" and its two hexadecimal digits. A valid JSON document without line
// breaks and tabs stays valid.
std::string escaped(std::string_view text);

// Returns the text with "?" in place of each character that escaped() would escape.
std::string without_controls(std::string_view text);

// Returns the beginning of a text for quotation in a message: at most `longest` bytes, not ending within a
// UTF-8 character, with control characters replaced as by without_controls().
std::string excerpt(std::string_view text, std::size_t longest = 40);

}  // namespace spoonbill
