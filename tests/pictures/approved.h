// Approved pictures in screenshots/. tests/approve replaces them by those that the program draws.
#pragma once

#include <string>

#include "render/image.h"

namespace spoonbill {

// Largest allowed mean difference of a block's channels, in 8-bit steps. Pictures of rasterisers on other
// processors differ by less than a third of this limit. The smallest change that must be detected makes a
// difference of more than twice this limit.
inline constexpr double picture_tolerance = 2.0;

// Compares a picture with the approved one of this name by their worst block of 16 x 16 pixels. If they
// differ, the test fails, and both are written to picture-failures/ of the build folder, with their
// difference. With SPOONBILL_APPROVE in the environment, the picture becomes the approved one.
void compare_with_approved(const std::string& name, const Image& actual);

}  // namespace spoonbill
