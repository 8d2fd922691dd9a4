// The boundaries of the lattice's hexahedra where they meet the body's surface (Fig. 11 of Pungotra et al.
// 2013). No GL.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/overlay/line.h"

namespace spoonbill {

// Those of faces that look at the eye, thick; and those of faces that look away, thinner and paler, to be
// drawn before a translucent body, through which they are seen.
struct CellLines {
  std::vector<OverlayLine> near, far;
};

// Appends the edges of the outer faces, each once. All are near where the lattice is a box about triangles.
void append_cell_lines(const LatticeSnapshot& lattice, const Eigen::Vector3f& eye_m, CellLines& lines);

}  // namespace spoonbill
