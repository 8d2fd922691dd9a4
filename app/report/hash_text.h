// State hashes as recordings and reports show them: sixteen hexadecimal digits.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace spoonbill {

inline std::string hash_text(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace spoonbill
