// How the cells of two regular grids over one block lie in each other.
#pragma once

#include <vector>

namespace spoonbill {

// A stretch of a block's cell that lies in one cell of the lattice, along one axis.
struct Stretch {
  int cell;          // of the lattice
  double low, high;  // -1 to 1 in the block's cell

  // Of the block's cell, 0 to 1.
  double share() const { return 0.5 * (high - low); }
};

// Of a cell of the block, in order and without gaps. Counts are of nodes along that axis, at least 2 each.
std::vector<Stretch> stretches(int block_cell, int block_count, int lattice_count);

}  // namespace spoonbill
