// The rims of a scan, where its surface ends: edges of holes and of open shapes.
#pragma once

#include <vector>

#include "engine/fitting/point_graph.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

// One closed way along the nodes of a rim; of a mesh such that what fills the hole faces as the mesh does.
struct Rim {
  std::vector<std::uint32_t> nodes;
  double length_m = 0.0;
  Vector3 centre_m = Vector3::Zero();
};

// Of a mesh: along its edges with one triangle. `node_of` gives each vertex its node of the graph. The
// longest first.
std::vector<Rim> rims_of_mesh(const std::vector<TriangleCorners>& triangles,
                              const std::vector<std::uint32_t>& node_of, const PointGraph& graph);

// Of a cloud: the nodes around which no neighbour lies within a wide angle, strung together. The longest
// first; only what closes to a ring.
std::vector<Rim> rims_of_cloud(const PointGraph& graph);

// A surface over a hole: the triangulation of its rim that has the least area (Barequet and Sharir 1995), cut
// finer.
struct Cap {
  std::vector<Vector3> points_m;  // further nodes, numbered from `first` on
  std::vector<Vector3> normals;   // of these, along the way that the rim is run through
  std::vector<NodePair> pairs;    // between these and the rim's
  double area_m2 = 0.0;
};
Cap cap_over(const PointGraph& graph, const Rim& rim, std::uint32_t first);

}  // namespace spoonbill
