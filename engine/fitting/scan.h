// Raw scans: points with optional normals and triangles, their voxels, outliers, spikes and long edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct Scan {
  std::vector<Vector3> points_m;
  // Empty, or one for each point: an outward unit vector, or zero where unknown.
  std::vector<Vector3> normals;
  std::vector<TriangleCorners> triangles;

  bool has_normals() const { return !normals.empty(); }
};

// Returns the diagonal of the bounding box, 0 without points.
double bounding_diagonal_m(const std::vector<Vector3>& points_m);

struct VoxelGroups {
  std::vector<std::uint32_t> group_index;  // group of each point
  std::size_t count = 0;
};

// Groups the points of each cubic cell. Points whose normals are nearest to different half axes form separate
// groups, so that the two faces of a thin wall stay separate.
VoxelGroups group_by_voxels(const Scan& scan, double side_m);

// Returns the side of voxels for which the scan has about `groups` groups: within 10 % of this number where
// possible, never more than 25 % above it.
double voxel_side_for(const Scan& scan, std::size_t groups);

// Returns the mean position and mean unit normal of each group.
Scan average_groups(const Scan& scan, const VoxelGroups& groups);

// Flags points that are much farther from their neighbours than usual. `counts` holds how many given points
// each point represents: 1, or in a thinned cloud the number of points in its voxel. The usual distance is a
// median weighted by these counts, because most given points are on the surface. A thinned point that
// represents far fewer points than usual is an outlier, too. In a thinned cloud, sparse points are not
// flagged where they and most of their neighbours are on planes, as on a surface.
std::vector<bool> find_outliers(const std::vector<Vector3>& points_m, const std::vector<double>& counts);

// Moves the tip of each spike to the centre of its ring of vertices and returns the tips; the connectivity
// does not change. All edges of a spike are much longer than usual, its height is at least four ring radii,
// and the surface around its ring is flat. The tip of a cone therefore counts as a spike only if the cone is
// that slender, consists of a single fan of triangles, and rises from a plate.
std::vector<std::uint32_t> level_spikes(Scan& mesh);

// Halves edges, at most 16 times in succession, until none is longer than `longest_m` or the triangle limit
// is reached. Both triangles at an edge are split, so that no gap opens. Existing points keep their
// positions; added points are appended.
void split_long_edges(std::vector<Vector3>& points_m, std::vector<TriangleCorners>& triangles,
                      double longest_m, std::size_t triangle_limit);

}  // namespace spoonbill
