// Reads PNG files for comparison.
#pragma once

#include <filesystem>

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

// Returns the image. Fails, with the path in the message, if the file is missing or damaged or if a side
// exceeds 16384 pixels.
Result<Image> read_png(const std::filesystem::path& path);

}  // namespace spoonbill
