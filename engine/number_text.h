// Numbers as error messages show them: the shortest decimals that read back as the same number.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace spoonbill {

inline std::string number_text(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

}  // namespace spoonbill
