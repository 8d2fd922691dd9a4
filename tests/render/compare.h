// Compares pictures by the block in which they differ most, so that a small change of one overlay is not
// averaged away by a large background.
#pragma once

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

inline constexpr int comparison_block_px = 16;

struct BlockDifference {
  // Largest mean absolute difference of a channel in any block, in 8-bit steps (0 to 255).
  double worst = 0.0;
  int x_px = 0;  // x_px and y_px: top left corner of the worst block
  int y_px = 0;
};

// Returns the largest difference over all blocks of 16 x 16 pixels; blocks at the right and lower edge may be
// smaller. Fails if the sizes differ.
Result<BlockDifference> worst_block_difference(const Image& expected, const Image& actual);

// Returns the absolute differences of colour, amplified eightfold, over a dimmed copy of `expected`; the
// worst block is framed. Fails if the sizes differ.
Result<Image> difference_picture(const Image& expected, const Image& actual);

// Returns whether a picture shows a panel at its left edge: whether most of the upper part of this edge
// differs from the right one, which shows the same backdrop.
bool has_panel(const Image& picture);

}  // namespace spoonbill
