// Whether a PLY file holds what its header promises: Assimp makes up what a cut one lacks, never ends, or
// crashes.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

inline constexpr std::size_t ply_header_bytes_limit = 65536;

// Reads the header and passes over all that it promises. The Error says what is wrong, without the file's
// name.
Status check_ply(const std::filesystem::path& file);

}  // namespace spoonbill
