#include "engine/exchange/cad/step_text.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace spoonbill {
namespace {

struct Letter {
  std::uint32_t code;
  std::size_t bytes;
};

// Of sound UTF-8 beyond ASCII.
Letter letter_at(std::string_view text, std::size_t start) {
  const auto byte = [&](std::size_t k) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k]));
  };
  const std::size_t wanted = byte(start) >= 0xf0 ? 4 : byte(start) >= 0xe0 ? 3 : 2;
  const std::size_t bytes = std::min(wanted, text.size() - start);
  std::uint32_t code = byte(start) & (0xffU >> (wanted + 1));
  for (std::size_t k = 1; k < bytes; ++k) code = (code << 6) | (byte(start + k) & 0x3f);
  return {code, bytes};
}

}  // namespace

std::string step_text_in_ascii(std::string_view text) {
  std::string ascii;
  ascii.reserve(text.size());
  for (std::size_t k = 0; k < text.size();) {
    if (static_cast<unsigned char>(text[k]) < 0x80) {
      ascii += text[k++];
      continue;
    }
    const Letter letter = letter_at(text, k);
    char escaped[24];
    std::snprintf(escaped, sizeof escaped, letter.code > 0xffff ? "\\X4\\%08X\\X0\\" : "\\X2\\%04X\\X0\\",
                  static_cast<unsigned>(letter.code));
    ascii += escaped;
    k += letter.bytes;
  }
  return ascii;
}

}  // namespace spoonbill
