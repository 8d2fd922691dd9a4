// Boundary loops of a scan: the edges of its holes and open ends, and the caps that close them.
#pragma once

#include <vector>

#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// Closed path along the nodes of a boundary. In a mesh, the loop runs such that a cap over the hole, oriented
// by the loop, has normals that agree with those of the mesh.
struct BoundaryLoop {
  std::vector<std::uint32_t> nodes;
  double length_m = 0.0;
  Vector3 centre_m = Vector3::Zero();
};

// Finds the loops along the mesh edges that belong to a single triangle, longest first. `node_index` maps
// each vertex to its node of the graph.
std::vector<BoundaryLoop> find_mesh_boundaries(const std::vector<TriangleCorners>& triangles,
                                               const std::vector<std::uint32_t>& node_index,
                                               const PointGraph& graph);

// Finds the boundary loops of a cloud, longest first: nodes with a wide empty angle around them, linked into
// closed rings. Open chains are dropped.
std::vector<BoundaryLoop> find_cloud_boundaries(const PointGraph& graph);

// Surface over a hole: the triangulation of the hole's loop with the least area (Barequet and Sharir 1995),
// refined to the spacing of the graph's nodes.
struct Cap {
  std::vector<Vector3> points_m;  // positions of the added nodes, numbered from `first` of cap_hole()
  std::vector<Vector3> normals;   // unit normals of the added nodes, oriented by the loop's sense of rotation
  std::vector<NodePair> pairs;    // edges of the cap's triangles, as numbers of nodes
  double area_m2 = 0.0;
};
Cap cap_hole(const PointGraph& graph, const BoundaryLoop& loop, std::uint32_t first);

}  // namespace spoonbill
