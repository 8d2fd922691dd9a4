// Reads PNG files, for comparison.
#pragma once

#include <filesystem>

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

// Refused, with the path: a missing file, a broken one, a side above 16384 pixels.
Result<Image> read_png(const std::filesystem::path& path);

}  // namespace spoonbill
