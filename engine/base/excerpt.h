// What was given, as error messages quote it.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace spoonbill {

// Its beginning, on one line: no control character, and no character of UTF-8 cut in two.
inline std::string excerpt(std::string_view text, std::size_t longest = 40) {
  if (longest < text.size()) {
    while (longest > 0 && (static_cast<unsigned char>(text[longest]) & 0xC0U) == 0x80U) --longest;
  }
  std::string line(text.substr(0, longest));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char letter) { return letter < ' ' || letter == 127; }, '?');
  return line;
}

}  // namespace spoonbill
