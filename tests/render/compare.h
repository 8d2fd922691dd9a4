// How much two pictures differ where they differ most: a small change of one overlay must not drown in a
// large background.
#pragma once

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

inline constexpr int comparison_block_px = 16;

struct BlockDifference {
  double worst =
      0.0;       // the greatest mean absolute difference of a channel over a block, in 8-bit steps (0..255)
  int x_px = 0;  // the top left corner of that block
  int y_px = 0;
};

// Over all blocks of 16 x 16 pixels (those at the right and lower edge may be smaller). Refused: different
// sizes.
Result<BlockDifference> worst_block_difference(const Image& expected, const Image& actual);

// The absolute differences of colour, amplified eightfold over a dimmed copy of `expected`, the worst block
// framed. Refused: different sizes.
Result<Image> difference_picture(const Image& expected, const Image& actual);

}  // namespace spoonbill
