// The format of a file, which the ending of its name alone decides.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace spoonbill {

// The ending in small letters, without the point.
inline std::string format_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return ending;
}

}  // namespace spoonbill
