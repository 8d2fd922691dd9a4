#include "app/report/csv_text.h"

#include <array>
#include <charconv>

namespace spoonbill {

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return quoted + '"';
}

void append_csv_number(std::string& line, double number) {
  std::array<char, 32> text{};
  // Adding zero turns a negative zero into a positive one.
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number + 0.0);
  line += ',';
  line.append(text.data(), end);
}

}  // namespace spoonbill
