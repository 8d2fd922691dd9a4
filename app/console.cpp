#include "app/console.h"

namespace spoonbill {

std::string one_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  for (std::size_t k = 0; k < line.size(); ++k) {
    const auto letter = static_cast<unsigned char>(line[k]);
    const bool is_wide_control =
        letter == 0xc2 && k + 1 < line.size() && static_cast<unsigned char>(line[k + 1]) < 0xa0;
    if (letter < ' ' || letter == 127) line[k] = '?';
    if (is_wide_control) line.replace(k, 2, "?");
  }
  return line;
}

}  // namespace spoonbill
