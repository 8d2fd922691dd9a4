// The parts of a snapshot that surfaces, lattice and material fill in. Sizes settle at the first call; later
// ones of the same structure allocate nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/material/spring_lattice.h"
#include "engine/simulation/scene.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

void write_surface(const Surface& surface, std::vector<SurfaceSnapshot>& out);

// held, touched: one byte a node.
void write_lattice(const SpringLattice& lattice, const std::vector<std::uint8_t>& held,
                   const std::vector<std::uint8_t>& touched, LatticeSnapshot& out);

void write_material(const Scene& scene, const SpringLattice& lattice, MaterialSnapshot& out);

}  // namespace spoonbill
