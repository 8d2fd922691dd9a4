// A whole file in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

// Refused: no regular file, an unreadable one, one above 256 MiB. The message begins with the path.
Result<std::vector<std::uint8_t>> read_bytes(const std::filesystem::path& path);

}  // namespace spoonbill
