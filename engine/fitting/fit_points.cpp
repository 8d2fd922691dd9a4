#include "engine/fitting/fit_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/fitting/islands.h"
#include "engine/fitting/normals.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"

namespace spoonbill {
namespace {

constexpr std::size_t least_scan_points = 30;
constexpr std::size_t neighbours_per_node = 9;

// Vertices of a mesh that are closer together than this fraction of the median edge are merged. The fraction
// is above the rounding errors of files with few digits, and below any edge that a scanner resolves.
constexpr double joining_edge_fraction = 1e-3;

// Returns the distance within which the vertices of a mesh are joined.
double joining_distance_m(const Scan& scan) {
  constexpr std::size_t most_measured = 1'000'000;
  std::vector<double> lengths;
  const std::size_t stride = 1 + scan.triangles.size() / most_measured;
  for (std::size_t t = 0; t < scan.triangles.size(); t += stride) {
    const auto& [a, b, c] = scan.triangles[t];
    for (const auto& [from, to] : {NodePair(a, b), NodePair(b, c), NodePair(c, a)}) {
      const double length_m = (scan.points_m[to] - scan.points_m[from]).norm();
      if (length_m > 0.0) lengths.push_back(length_m);
    }
  }
  const double rounding_m = vertex_joining_fraction * bounding_diagonal_m(scan.points_m);
  return std::max({joining_edge_fraction * median(std::move(lengths)), rounding_m, 1e-12});
}

void join_near_vertices(Scan& scan, double distance_m) {
  const JoinedVertices joined = join_vertices(scan.points_m, distance_m);
  std::vector<TriangleCorners> remaining;
  remaining.reserve(scan.triangles.size());
  for (TriangleCorners corners : scan.triangles) {
    for (std::uint32_t& corner : corners) corner = joined.joined_into[corner];
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) {
      remaining.push_back(corners);
    }
  }
  scan.points_m = joined.vertices_m;
  scan.triangles = std::move(remaining);
}

// Returns true if the points spread across their main axis only by rounding errors.
bool are_collinear(const std::vector<Vector3>& points_m) {
  const auto count = static_cast<double>(points_m.size());
  Vector3 centre = Vector3::Zero();
  for (const Vector3& point : points_m) centre += point / count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3& point : points_m) scatter += (point - centre) * (point - centre).transpose();
  const Vector3 squares = decompose_symmetric(scatter).values;
  return squares[1] <= 1e-12 * squares[2];
}

double mesh_area(const Scan& scan) {
  double area = 0.0;
  for (const auto& [a, b, c] : scan.triangles) {
    area += 0.5 * (scan.points_m[b] - scan.points_m[a]).cross(scan.points_m[c] - scan.points_m[a]).norm();
  }
  return area;
}

void refine(Scan& scan) {
  const double longest = 1.2 * std::sqrt(mesh_area(scan) / static_cast<double>(node_target));
  split_long_edges(scan.points_m, scan.triangles, longest, 3 * fitted_point_limit);
}

// Computes area-weighted vertex normals. Returns the weight of each vertex, a third of the area of its
// triangles. Vertices without triangles get zeros.
std::vector<double> compute_vertex_normals(Scan& scan) {
  std::vector<double> weights(scan.points_m.size(), 0.0);
  scan.normals.assign(scan.points_m.size(), Vector3::Zero());
  for (const TriangleCorners& t : scan.triangles) {
    const Vector3 twice_area =
        (scan.points_m[t[1]] - scan.points_m[t[0]]).cross(scan.points_m[t[2]] - scan.points_m[t[0]]);
    for (const std::uint32_t corner : t) {
      scan.normals[corner] += twice_area;
      weights[corner] += twice_area.norm() / 6.0;
    }
  }
  for (Vector3& normal : scan.normals) {
    const double length = normal.norm();
    normal = length > 1e-30 ? Vector3(normal / length) : Vector3::Zero();
  }
  return weights;
}

// Reduces the number of points to the limit by voxels and sums the weights of merged points. In a cloud, a
// weight is a number of points. Keeps every triangle whose corners are in at least two voxels, because its
// sides give the edges between the voxels' points.
void thin(Scan& scan, std::vector<double>& weights, std::vector<std::uint32_t>& representative) {
  if (scan.points_m.size() <= fitted_point_limit + fitted_point_limit / 4) return;
  const VoxelGroups groups = group_by_voxels(scan, voxel_side_for(scan, fitted_point_limit));
  Scan thinned = average_groups(scan, groups);
  std::vector<double> sums(groups.count, 0.0);
  for (std::size_t p = 0; p < weights.size(); ++p) sums[groups.group_index[p]] += weights[p];
  for (TriangleCorners corners : scan.triangles) {
    for (std::uint32_t& corner : corners) corner = groups.group_index[corner];
    if (corners[0] != corners[1] || corners[1] != corners[2]) thinned.triangles.push_back(corners);
  }
  for (std::uint32_t& point : representative) point = groups.group_index[point];
  scan = std::move(thinned);
  weights = std::move(sums);
}

void remove_points(FitPoints& fit, const std::vector<bool>& is_removed) {
  std::uint32_t remaining = 0;
  std::vector<std::uint32_t> new_index(is_removed.size(), no_point);
  for (std::size_t p = 0; p < is_removed.size(); ++p) {
    if (is_removed[p]) continue;
    new_index[p] = remaining;
    fit.scan.points_m[remaining] = fit.scan.points_m[p];
    if (fit.scan.has_normals()) fit.scan.normals[remaining] = fit.scan.normals[p];
    fit.weights[remaining] = fit.weights[p];
    ++remaining;
  }
  for (std::uint32_t& point : fit.representative) {
    point = new_index[point];
    if (point == no_point) ++fit.outliers;
  }
  fit.scan.points_m.resize(remaining);
  if (fit.scan.has_normals()) fit.scan.normals.resize(remaining);
  fit.weights.resize(remaining);
}

std::vector<NodePair> mesh_pairs(const Scan& scan, const std::vector<std::uint32_t>& node_index) {
  std::vector<NodePair> pairs;
  for (const TriangleCorners& t : scan.triangles) {
    for (std::size_t k = 0; k < 3; ++k) pairs.emplace_back(node_index[t[k]], node_index[t[(k + 1) % 3]]);
  }
  return pairs;
}

// Pairs each node with its nearest nodes, unless they are much farther away than usual or have opposed
// normals.
std::vector<NodePair> cloud_pairs(const Scan& nodes) {
  const NearestPoints nearest(nodes.points_m);
  std::vector<NearestPoints::Neighbour> found;
  std::vector<NodePair> pairs;
  std::vector<double> lengths;
  for (std::uint32_t n = 0; n < nodes.points_m.size(); ++n) {
    nearest.nearest(nodes.points_m[n], neighbours_per_node + 1, found);
    for (const NearestPoints::Neighbour& other : found) {
      if (other.index == n) continue;
      if (nodes.has_normals() && nodes.normals[n].dot(nodes.normals[other.index]) < -0.2) continue;
      pairs.emplace_back(n, other.index);
      lengths.push_back(other.distance);
    }
  }
  if (pairs.empty()) return pairs;
  const double longest = 3.0 * median(lengths);
  std::size_t remaining = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (lengths[k] <= longest) pairs[remaining++] = pairs[k];
  }
  pairs.resize(remaining);
  return pairs;
}

// Groups the points into nodes. In a cloud there are at least three points per node on average, so that the
// nodes are spaced more evenly than the points.
VoxelGroups groups_for_nodes(const Scan& scan) {
  const std::size_t count = scan.points_m.size();
  const std::size_t target = scan.triangles.empty() ? std::min(node_target, count / 3) : 4 * node_target;
  if (count > target) return group_by_voxels(scan, voxel_side_for(scan, std::min(target, node_target)));
  VoxelGroups groups;
  groups.count = count;
  groups.group_index.resize(count);
  std::iota(groups.group_index.begin(), groups.group_index.end(), 0U);
  return groups;
}

// Flips inconsistent normals. Returns true if any were flipped.
bool flip_normals(FitPoints& fit, const VoxelGroups& groups, const Scan& nodes) {
  const std::vector<bool> is_flipped = find_inconsistent_normals(nodes);
  for (std::size_t p = 0; p < fit.scan.normals.size(); ++p) {
    if (is_flipped[groups.group_index[p]]) fit.scan.normals[p] = -fit.scan.normals[p];
  }
  for (const std::uint32_t point : fit.representative) {
    if (point != no_point && is_flipped[groups.group_index[point]]) ++fit.flipped_normals;
  }
  return fit.flipped_normals > 0;
}

void make_nodes(FitPoints& fit) {
  const bool is_mesh = !fit.scan.triangles.empty();
  VoxelGroups groups = groups_for_nodes(fit.scan);
  Scan nodes = average_groups(fit.scan, groups);
  if (!is_mesh && fit.scan.has_normals() && flip_normals(fit, groups, nodes)) {
    groups = groups_for_nodes(fit.scan);
    nodes = average_groups(fit.scan, groups);
  }
  const auto pairs = is_mesh
                         ? mesh_pairs(fit.scan, groups.group_index)
                         : remove_gap_pairs(fit.scan.points_m, groups, nodes.points_m, cloud_pairs(nodes));
  fit.node_index = std::move(groups.group_index);
  fit.node_normals = nodes.has_normals() ? std::move(nodes.normals)
                                         : std::vector<Vector3>(nodes.points_m.size(), Vector3::Zero());
  fit.graph = make_point_graph(std::move(nodes.points_m), pairs);
  fit.boundary_loops = is_mesh ? find_mesh_boundaries(fit.scan.triangles, fit.node_index, fit.graph)
                               : find_cloud_boundaries(fit.graph);
  fit.scan.triangles.clear();
}

}  // namespace

Result<FitPoints> make_fit_points(Scan scan) {
  SPOONBILL_ASSERT(!scan.has_normals() || scan.normals.size() == scan.points_m.size());
  const bool is_mesh = !scan.triangles.empty();
  FitPoints fit;
  fit.is_mesh = is_mesh;
  fit.weights.assign(scan.points_m.size(), 1.0);
  if (is_mesh) {
    fit.joined = scan.points_m.size();
    fit.joining_distance_m = joining_distance_m(scan);
    join_near_vertices(scan, fit.joining_distance_m);
    fit.joined -= scan.points_m.size();
  }
  fit.given_m = scan.points_m;
  fit.representative.resize(fit.given_m.size());
  std::iota(fit.representative.begin(), fit.representative.end(), 0U);
  std::vector<std::uint32_t> spikes;
  if (is_mesh) {
    if (!(mesh_area(scan) > 0.0)) return Error(ErrorCode::degenerate, "its triangles have no area");
    spikes = level_spikes(scan);
    refine(scan);
    fit.weights = compute_vertex_normals(scan);
  }
  if (scan.points_m.size() < least_scan_points) {
    return Error(ErrorCode::too_few, "has too few points for a fit: " + std::to_string(scan.points_m.size()) +
                                         ", needs at least " + std::to_string(least_scan_points));
  }
  if (!(bounding_diagonal_m(scan.points_m) > 0.0))
    return Error(ErrorCode::degenerate, "all its points coincide");
  if (are_collinear(scan.points_m)) return Error(ErrorCode::degenerate, "all its points are on one line");
  thin(scan, fit.weights, fit.representative);
  fit.scan = std::move(scan);
  fit.outliers = spikes.size();
  for (const std::uint32_t spike : spikes) fit.representative[spike] = no_point;
  if (!is_mesh) {
    remove_points(fit, find_outliers(fit.scan.points_m, fit.weights));
    // All weights are set equal, so that dense and sparse regions count alike.
    fit.weights.assign(fit.weights.size(), 1.0);
  }
  make_nodes(fit);
  return fit;
}

std::vector<Vector2> use_points_as_nodes(FitPoints& points, const std::vector<Vector2>& uv) {
  SPOONBILL_ASSERT(uv.size() == points.scan.points_m.size());
  const std::size_t count = points.scan.points_m.size(), stride = 1 + count / (4 * node_target);
  std::vector<Vector3> nodes, positions;
  std::vector<Vector2> node_uv;
  for (std::size_t p = 0; p < count; p += stride) {
    nodes.push_back(points.scan.points_m[p]);
    node_uv.push_back(uv[p]);
    positions.emplace_back(uv[p].x(), uv[p].y(), 0.0);
  }
  const NearestPoints nearest(positions);
  for (std::size_t p = 0; p < count; ++p) {
    points.node_index[p] = nearest.nearest({uv[p].x(), uv[p].y(), 0.0}).index;
  }
  points.node_normals.assign(nodes.size(), Vector3::Zero());
  points.boundary_loops.clear();
  points.graph = make_point_graph(std::move(nodes), {});
  return node_uv;
}

void add_spanning_nodes(FitPoints& points, const std::vector<Vector3>& positions_m,
                        const std::vector<Vector3>& normals, const std::vector<NodePair>& pairs) {
  SPOONBILL_ASSERT(normals.empty() || normals.size() == positions_m.size());
  std::vector<NodePair> all = pairs;
  for (std::uint32_t n = 0; n < points.graph.size(); ++n) {
    for (const std::uint32_t other : points.graph.adjacent(n)) {
      if (other > n) all.emplace_back(n, other);
    }
  }
  std::vector<Vector3> nodes = std::move(points.graph.points_m);
  nodes.insert(nodes.end(), positions_m.begin(), positions_m.end());
  points.node_normals.insert(points.node_normals.end(), normals.begin(), normals.end());
  points.spanning_nodes += positions_m.size();
  points.graph = make_point_graph(std::move(nodes), all);
}

}  // namespace spoonbill
