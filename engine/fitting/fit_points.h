// A scan made ready for fitting: the points that take part, thinned, and a graph of fewer nodes over them.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/fitting/parameterisation.h"
#include "engine/fitting/point_graph.h"
#include "engine/fitting/rims.h"
#include "engine/fitting/scan.h"

namespace spoonbill {

inline constexpr std::size_t fitted_point_limit = 120'000;
inline constexpr std::size_t node_target = 5000;
inline constexpr std::uint32_t no_point = 0xffffffffU;

struct FitPoints {
  bool is_mesh = false;  // has no points apart from its surface then but spikes
  Scan scan;             // thinned, cleaned; triangles no longer
  // Of each point given (of a mesh: of each vertex left after joining) the one above that stands for it, or
  // no_point where it was left out; with where it lies.
  std::vector<Vector3> given_m;
  std::vector<std::uint32_t> stands_for;
  std::vector<double> weights;         // what each point stands for: an area of a mesh, 1 of a cloud
  PointGraph graph;                    // nodes among and between the points
  std::vector<Vector3> node_normals;   // unit where they are known; else zero
  std::vector<std::uint32_t> node_of;  // of each point
  std::vector<Rim> rims;               // where the surface ends, the longest first
  std::size_t spanning_nodes = 0;      // the last so many nodes have no points: they span holes and gaps
  std::size_t outliers = 0;            // points given that lie apart from all others; of a mesh its spikes
  std::size_t joined = 0;              // vertices of a mesh that lay where another did
  std::size_t turned_normals = 0;      // points given whose normals faced otherwise than those beside them
};

// Joins the vertices of a mesh, levels its spikes, refines its triangles to the nodes' spacing, gives its
// vertices normals; thins a cloud by voxels, leaves out what lies apart and turns normals that do not agree.
// Refused: fewer than 30 points, all of them in one place or on one line.
Result<FitPoints> make_fit_points(Scan scan);

// Makes some of the points themselves the nodes, without neighbours: for clouds whose parameters are known
// already, those of the points, and whose neighbours mislead. The nodes' follow.
std::vector<Vector2> take_points_as_nodes(FitPoints& points, const std::vector<Vector2>& uv);

// Adds nodes that span a hole or a gap; `pairs` join them, whose numbers begin at graph.size(), to others.
void add_spanning_nodes(FitPoints& points, const std::vector<Vector3>& places_m,
                        const std::vector<Vector3>& normals, const std::vector<NodePair>& pairs);

}  // namespace spoonbill
