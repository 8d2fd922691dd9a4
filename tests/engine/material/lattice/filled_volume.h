// Computes the volume of a lattice's cells that is filled with material.
#pragma once

#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

inline double filled_m3(const LatticeMesh& mesh) {
  double volume = 0.0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        volume += mesh.cell_fraction(i, j, k) * cell_volume(mesh.cell(i, j, k));
      }
    }
  }
  return volume;
}

}  // namespace spoonbill
