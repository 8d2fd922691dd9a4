// The needles that a scanner's mesh has where single points were seen far off the surface.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/fitting/scan.h"

namespace spoonbill {

// Moves the tip of each needle into the middle of the ring of vertices about it, so that the mesh hangs
// together as before, and returns the tips: vertices all of whose edges are much longer than is usual, which
// rise to at least four times the radius of their ring, and whose ring lies in a face that goes on around it.
// The tip of a cone is none, unless it is as slender, a single fan of triangles, and stands on a plate.
std::vector<std::uint32_t> level_spikes(Scan& mesh);

}  // namespace spoonbill
