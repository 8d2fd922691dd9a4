#include "render/image/image.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {

void flip_rows(Image& image) {
  SPOONBILL_ASSERT(image.rgba.size() == image.row_bytes() * static_cast<std::size_t>(image.height));
  for (int top = 0, bottom = image.height - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(image.pixel(0, top), image.pixel(0, top) + image.row_bytes(), image.pixel(0, bottom));
  }
}

}  // namespace spoonbill
