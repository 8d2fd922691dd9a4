// Scan prepared for fitting: the thinned points to which the surface is fitted, and a graph of fewer nodes
// over them.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/fitting/boundary_loops.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

inline constexpr std::size_t fitted_point_limit = 120'000;
inline constexpr std::size_t node_target = 5000;
inline constexpr std::uint32_t no_point = 0xffffffffU;

struct FitPoints {
  bool is_mesh = false;  // in a mesh, only spikes count as outliers
  Scan scan;             // points after thinning and cleaning, without triangles
  // Positions of the points that were given, or of a mesh's vertices after joining. For each of them,
  // `representative` holds the index of the scan point that represents it, or no_point if it was removed.
  std::vector<Vector3> given_m;
  std::vector<std::uint32_t> representative;
  std::vector<double> weights;               // weight of each scan point: its area in a mesh, 1 in a cloud
  PointGraph graph;                          // graph of the nodes, each of which represents nearby points
  std::vector<Vector3> node_normals;         // unit vectors, or zero where the normal is unknown
  std::vector<std::uint32_t> node_index;     // index of the node of each scan point
  std::vector<BoundaryLoop> boundary_loops;  // sorted by length, the longest first
  // Number of nodes that span holes and gaps. They have no points and are the last nodes of the graph.
  std::size_t spanning_nodes = 0;
  std::size_t outliers = 0;  // number of given points removed as outliers; in a mesh, number of spikes
  std::size_t joined = 0;    // number of mesh vertices merged with another vertex within the joining distance
  double joining_distance_m = 0.0;  // 0 for a cloud, whose points are not joined
  // Number of given points whose normals were flipped to agree with neighbouring normals.
  std::size_t flipped_normals = 0;
};

// Prepares a scan. In a mesh, joins vertices nearer than a thousandth of the median edge and flattens spikes.
// Then divides long triangle edges to about the spacing of the graph's nodes, and computes vertex normals. If
// there are many points, thins them by voxels. In a cloud, removes outliers and flips inconsistent normals.
// Fails with fewer than 30 points, or if all points coincide or are collinear.
Result<FitPoints> make_fit_points(Scan scan);

// Replaces the nodes by a subset of the points, without edges, and returns the nodes' parameters. `uv` holds
// the known parameters of all points. Needed for clouds of thin walls, where a point's nearest neighbours in
// space may be on the opposite face.
std::vector<Vector2> use_points_as_nodes(FitPoints& points, const std::vector<Vector2>& uv);

// Adds nodes that span a hole or a gap. `pairs` connects them to other nodes. The added nodes get the numbers
// that follow those of the existing nodes.
void add_spanning_nodes(FitPoints& points, const std::vector<Vector3>& positions_m,
                        const std::vector<Vector3>& normals, const std::vector<NodePair>& pairs);

}  // namespace spoonbill
