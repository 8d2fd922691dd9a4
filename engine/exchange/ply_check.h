// Whether a PLY file holds what its header promises: Assimp makes up what a cut one lacks, or never ends.
#pragma once

#include <filesystem>

#include "engine/result.h"

namespace spoonbill {

inline constexpr std::size_t ply_header_bytes_limit = 65536;

// Reads the header and, of a text file, all of its numbers. The Error says what is wrong, without the file's
// name.
Status check_ply(const std::filesystem::path& file);

}  // namespace spoonbill
