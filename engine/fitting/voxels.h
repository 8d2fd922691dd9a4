// Points gathered into the cells of a cubic lattice.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/fitting/scan.h"

namespace spoonbill {

struct VoxelGroups {
  std::vector<std::uint32_t> group_of;  // of each point
  std::size_t count = 0;
};

// Points in one cell whose normals, where there are any, point the same way of six are one group: the two
// faces of a thin wall stay apart.
VoxelGroups group_by_voxels(const Scan& scan, double side_m);

// The side that gives about so many groups, to a tenth, and never more than a quarter above it.
double voxel_side_for(const Scan& scan, std::size_t groups);

// The middle of each group, with the mean of its normals.
Scan middles_of(const Scan& scan, const VoxelGroups& groups);

}  // namespace spoonbill
