// The lattice's nodes and edges as marks and lines (Fig. 7 of Pungotra et al. 2013). No GL.
#pragma once

#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/overlay/line.h"
#include "render/overlay/mark.h"

namespace spoonbill {

// The shortest of the three directions' mean edges, in metres, which marks must fit between.
// Zero for a lattice without edges.
float mean_edge_m(const LatticeSnapshot& lattice);

// Appends a green square for each fixed node of the shell (all fixed nodes with `inner`).
void append_fixed_marks(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayMark>& marks);

// Appends a red disc for each touched node.
void append_touched_marks(const LatticeSnapshot& lattice, std::vector<OverlayMark>& marks);

// Appends the edges between neighbouring nodes of the shell (all edges with `inner`).
void append_lattice_lines(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayLine>& lines);

}  // namespace spoonbill
