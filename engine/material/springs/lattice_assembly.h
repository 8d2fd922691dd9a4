// How a spring lattice is put together from its cells. Private to SpringLattice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// The 13 directions of a regular lattice as steps in i, j, k, each with a positive offset in memory.
inline constexpr int direction_step[lattice_direction_count][3] = {
    {0, 1, 0}, {1, 0, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {0, 1, 1},   {0, -1, 1},
    {1, 0, 1}, {-1, 0, 1}, {1, 1, 1}, {1, -1, 1}, {-1, 1, 1}, {-1, -1, 1},
};

// -1 where there is none.
inline int direction_of(int di, int dj, int dk) {
  for (int d = 0; d < lattice_direction_count; ++d) {
    if (direction_step[d][0] == di && direction_step[d][1] == dj && direction_step[d][2] == dk) return d;
  }
  return -1;
}

// A fixed, well-mixed sequence (Knuth's multiplicative hash), so that no mode is absent from it.
inline float mixed(std::uint32_t i) {
  const std::uint32_t bits = (i * 2654435761u) ^ ((i * 2654435761u) >> 15);
  return static_cast<float>(bits & 0xffffu) / 32768.0f - 1.0f;
}

// What the cells add up to, in double, before it is stored in single precision.
struct SpringLattice::Assembly {
  // Of each direction, one a node: of the spring that starts there.
  using BySpring = std::array<std::vector<double>, lattice_direction_count>;

  // One of the materials, as far as it is softened.
  struct Stiffness {
    double youngs_modulus_pa, shear_pa, bulk_pa;
  };

  explicit Assembly(const SpringLattice& of);

  // Of the first material that gives a spring most of its stiffness. Of a lattice of several.
  std::size_t leading_material(int direction, std::size_t node) const;

  std::vector<Stiffness> materials;
  std::vector<double> mass, cell_count;  // one a node
  BySpring stiffness;
  std::vector<BySpring> by_material;  // what each gives; empty where there is but one
};

}  // namespace spoonbill
