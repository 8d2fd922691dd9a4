// Text of CSV files (RFC 4180).
#pragma once

#include <string>
#include <string_view>

namespace spoonbill {

// Returns the text as a field, quoted if it contains a comma, a quote or a line break.
std::string csv_field(const std::string& text);

// Appends a comma and the shortest decimal text that parses to the same number. A negative zero becomes zero.
void append_csv_number(std::string& line, double number);

}  // namespace spoonbill
