#include "engine/fitting/estimated_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/fitting/normal_signs.h"

namespace spoonbill {
namespace {

// Of the spread along the plane: more is an edge, or two faces in one.
constexpr double flat_share = 0.15;
constexpr double most_against = 0.2;

// Those about a node, in two steps.
std::vector<std::uint32_t> around(const PointGraph& graph, std::uint32_t node) {
  std::vector<std::uint32_t> near{node};
  for (const std::uint32_t other : graph.of(node)) {
    near.push_back(other);
    near.insert(near.end(), graph.of(other).begin(), graph.of(other).end());
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

Vector3 normal_at(const PointGraph& graph, std::uint32_t node) {
  const std::vector<std::uint32_t> near = around(graph, node);
  Vector3 middle = Vector3::Zero();
  for (const std::uint32_t other : near) middle += graph.points_m[other] / static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const std::uint32_t other : near) {
    const Vector3 way = graph.points_m[other] - middle;
    scatter += way * way.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  const Vector3& squares = axes.eigenvalues();
  const bool is_flat = squares[1] > 0.0 && squares[0] < flat_share * flat_share * squares[1];
  return is_flat ? Vector3(axes.eigenvectors().col(0)) : Vector3::Zero();
}

std::vector<NodePair> pairs_between(const PointGraph& graph, const std::vector<Vector3>& normals) {
  std::vector<NodePair> pairs;
  for (std::uint32_t n = 0; n < graph.size(); ++n) {
    for (const std::uint32_t other : graph.of(n)) {
      if (other > n && !normals[n].isZero() && !normals[other].isZero()) pairs.emplace_back(n, other);
    }
  }
  return pairs;
}

// How many points of each part the surface faces as their nodes do, and how many it does not.
struct Votes {
  std::vector<double> along, against;

  // Of the part's normals: 1, -1, or 0 where they are not to be trusted.
  double sign_of(std::uint32_t part) const {
    const double fewer = std::min(along[part], against[part]);
    if (fewer > most_against * (along[part] + against[part])) return 0.0;
    return along[part] >= against[part] ? 1.0 : -1.0;
  }
};

}  // namespace

std::vector<Vector3> estimated_normals(const FitPoints& points, const Surface& surface,
                                       const std::vector<Vector2>& uv) {
  std::vector<Vector3> of_nodes(points.graph.size());
  for (std::uint32_t n = 0; n < of_nodes.size(); ++n) of_nodes[n] = normal_at(points.graph, n);
  const std::vector<NodePair> pairs = pairs_between(points.graph, of_nodes);
  const std::vector<bool> turned = turned_to_agree(points.graph.points_m, of_nodes, pairs);
  for (std::size_t n = 0; n < of_nodes.size(); ++n) {
    if (turned[n]) of_nodes[n] = -of_nodes[n];
  }
  const GraphParts parts = connected_parts(make_point_graph(points.graph.points_m, pairs));
  Votes votes{std::vector<double>(parts.sizes.size(), 0.0), std::vector<double>(parts.sizes.size(), 0.0)};
  for (std::size_t p = 0; p < points.node_of.size(); ++p) {
    const SurfacePoint at = evaluate(surface, uv[p].x(), uv[p].y());
    const double cosine = at.du.cross(at.dv).dot(of_nodes[points.node_of[p]]);
    if (cosine > 0.0) votes.along[parts.part_of[points.node_of[p]]] += 1.0;
    if (cosine < 0.0) votes.against[parts.part_of[points.node_of[p]]] += 1.0;
  }
  std::vector<Vector3> normals(uv.size(), Vector3::Zero());
  for (std::size_t p = 0; p < points.node_of.size(); ++p) {
    const std::uint32_t node = points.node_of[p];
    normals[p] = votes.sign_of(parts.part_of[node]) * of_nodes[node];
  }
  return normals;
}

}  // namespace spoonbill
