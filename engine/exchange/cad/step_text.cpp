#include "engine/exchange/cad/step_text.h"

#include <cstdint>
#include <cstdio>

namespace spoonbill {
namespace {

const char* const two_bytes = "\\X2\\";
const char* const four_bytes = "\\X4\\";

struct Letter {
  std::uint32_t code;
  std::size_t bytes;
};

// Of sound UTF-8 beyond ASCII. A line may have been broken in the middle of a letter.
Letter letter_at(std::string_view text, std::size_t start) {
  const auto byte = [&](std::size_t k) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k]));
  };
  const std::size_t wanted = byte(start) >= 0xf0 ? 4 : byte(start) >= 0xe0 ? 3 : 2;
  std::uint32_t code = byte(start) & (0xffU >> (wanted + 1));
  std::size_t end = start + 1;
  for (std::size_t more = 1; more < wanted && end < text.size(); ++end) {
    if (text[end] == '\n') continue;
    code = (code << 6) | (byte(end) & 0x3f);
    ++more;
  }
  return {code, end - start};
}

}  // namespace

std::string step_text_in_ascii(std::string_view text) {
  std::string ascii;
  ascii.reserve(text.size());
  const char* open = nullptr;  // what the letters at hand are written after
  const auto write_after = [&](const char* wanted) {
    if (open == wanted) return;
    if (open != nullptr) ascii += "\\X0\\";
    if (wanted != nullptr) ascii += wanted;
    open = wanted;
  };
  for (std::size_t k = 0; k < text.size();) {
    if (static_cast<unsigned char>(text[k]) < 0x80) {
      write_after(nullptr);
      ascii += text[k++];
      continue;
    }
    const Letter letter = letter_at(text, k);
    const bool is_wide = letter.code > 0xffff;
    write_after(is_wide ? four_bytes : two_bytes);
    char digits[12];
    std::snprintf(digits, sizeof digits, is_wide ? "%08X" : "%04X", static_cast<unsigned>(letter.code));
    ascii += digits;
    k += letter.bytes;
  }
  write_after(nullptr);
  return ascii;
}

}  // namespace spoonbill
