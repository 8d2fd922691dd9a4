// What a deformed lattice cell stores and how it pushes back, whatever it is made of.
#pragma once

#include <array>
#include <cstdint>

#include "engine/material/cells/hexahedron.h"

namespace spoonbill {

// The displacements of a cell's corners from the rest shape, m: from positions, stiff cells would lose the
// digits that the forces are made of.
using CellMoves = std::array<Vector3, 8>;

struct CellResponse {
  double energy_j = 0.0;
  CellVector force_n;  // the gradient of the energy: what holds the cell so
  CellMatrix tangent;  // how the force changes, N/m
};

// Whether a tangent holds what the present stress adds to it. With it, Newton's method is at its fastest;
// without, no stress makes it indefinite.
enum class Tangent : std::uint8_t { stressed, plain };

}  // namespace spoonbill
