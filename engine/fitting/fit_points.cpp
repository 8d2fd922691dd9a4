#include "engine/fitting/fit_points.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/fitting/gaps.h"
#include "engine/fitting/nearest_points.h"
#include "engine/fitting/normal_signs.h"
#include "engine/fitting/outliers.h"
#include "engine/fitting/quantiles.h"
#include "engine/fitting/side_cutting.h"
#include "engine/fitting/spikes.h"
#include "engine/fitting/voxels.h"

namespace spoonbill {
namespace {

constexpr std::size_t least_points = 30;
constexpr std::size_t neighbours_of_a_node = 9;

void join(Scan& scan) {
  const JoinedVertices joined =
      join_vertices(scan.points_m, std::max(vertex_joining_fraction * size_of(scan.points_m), 1e-12));
  std::vector<TriangleCorners> kept;
  kept.reserve(scan.triangles.size());
  for (TriangleCorners corners : scan.triangles) {
    for (std::uint32_t& corner : corners) corner = joined.joined_into[corner];
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) {
      kept.push_back(corners);
    }
  }
  scan.points_m = joined.vertices_m;
  scan.triangles = std::move(kept);
}

// Their spread across it is rounding beside that along it.
bool lie_on_a_line(const std::vector<Vector3>& points_m) {
  const auto count = static_cast<double>(points_m.size());
  Vector3 middle = Vector3::Zero();
  for (const Vector3& point : points_m) middle += point / count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3& point : points_m) scatter += (point - middle) * (point - middle).transpose();
  const Vector3 squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
  return squares[1] <= 1e-12 * squares[2];
}

double area_of(const Scan& scan) {
  double area = 0.0;
  for (const auto& [a, b, c] : scan.triangles) {
    area += 0.5 * (scan.points_m[b] - scan.points_m[a]).cross(scan.points_m[c] - scan.points_m[a]).norm();
  }
  return area;
}

void refine(Scan& scan) {
  const double longest = 1.2 * std::sqrt(area_of(scan) / static_cast<double>(node_target));
  cut_long_sides(scan.points_m, scan.triangles, longest, 3 * fitted_point_limit);
}

// Normals of the vertices by the areas of their triangles, and a third of these areas as weights. Vertices
// without a triangle get neither.
std::vector<double> take_normals(Scan& scan) {
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

// Thinned to the limit by voxels; `weights` go with their points: those of a cloud count the points that each
// stands for. Pairs of groups in one triangle remain pairs.
void thin(Scan& scan, std::vector<double>& weights, std::vector<std::uint32_t>& stands_for) {
  if (scan.points_m.size() <= fitted_point_limit + fitted_point_limit / 4) return;
  const VoxelGroups groups = group_by_voxels(scan, voxel_side_for(scan, fitted_point_limit));
  Scan thinned = middles_of(scan, groups);
  std::vector<double> sums(groups.count, 0.0);
  for (std::size_t p = 0; p < weights.size(); ++p) sums[groups.group_of[p]] += weights[p];
  for (TriangleCorners corners : scan.triangles) {
    for (std::uint32_t& corner : corners) corner = groups.group_of[corner];
    if (corners[0] != corners[1] || corners[1] != corners[2]) thinned.triangles.push_back(corners);
  }
  for (std::uint32_t& point : stands_for) point = groups.group_of[point];
  scan = std::move(thinned);
  weights = std::move(sums);
}

void keep_only(FitPoints& fit, const std::vector<bool>& leave_out) {
  std::uint32_t kept = 0;
  std::vector<std::uint32_t> place(leave_out.size(), no_point);
  for (std::size_t p = 0; p < leave_out.size(); ++p) {
    if (leave_out[p]) continue;
    place[p] = kept;
    fit.scan.points_m[kept] = fit.scan.points_m[p];
    if (fit.scan.has_normals()) fit.scan.normals[kept] = fit.scan.normals[p];
    fit.weights[kept] = fit.weights[p];
    ++kept;
  }
  for (std::uint32_t& point : fit.stands_for) {
    point = place[point];
    if (point == no_point) ++fit.outliers;
  }
  fit.scan.points_m.resize(kept);
  if (fit.scan.has_normals()) fit.scan.normals.resize(kept);
  fit.weights.resize(kept);
}

std::vector<NodePair> pairs_of_mesh(const Scan& scan, const std::vector<std::uint32_t>& node_of) {
  std::vector<NodePair> pairs;
  for (const TriangleCorners& t : scan.triangles) {
    for (std::size_t k = 0; k < 3; ++k) pairs.emplace_back(node_of[t[k]], node_of[t[(k + 1) % 3]]);
  }
  return pairs;
}

// The nearest nodes of each, unless they are far beyond what is usual or face the other way.
std::vector<NodePair> pairs_of_cloud(const Scan& nodes) {
  const NearestPoints nearest(nodes.points_m);
  std::vector<NearestPoints::Found> found;
  std::vector<NodePair> pairs;
  std::vector<double> lengths;
  for (std::uint32_t n = 0; n < nodes.points_m.size(); ++n) {
    nearest.nearest(nodes.points_m[n], neighbours_of_a_node + 1, found);
    for (const NearestPoints::Found& other : found) {
      if (other.index == n) continue;
      if (nodes.has_normals() && nodes.normals[n].dot(nodes.normals[other.index]) < -0.2) continue;
      pairs.emplace_back(n, other.index);
      lengths.push_back(other.distance);
    }
  }
  if (pairs.empty()) return pairs;
  const double longest = 3.0 * median_of(lengths);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (lengths[k] <= longest) pairs[kept++] = pairs[k];
  }
  pairs.resize(kept);
  return pairs;
}

// The nodes of a cloud are means of some points, which lie more evenly than these.
VoxelGroups groups_for_nodes(const Scan& scan) {
  const std::size_t count = scan.points_m.size();
  const std::size_t target = scan.triangles.empty() ? std::min(node_target, count / 3) : 4 * node_target;
  if (count > target) return group_by_voxels(scan, voxel_side_for(scan, std::min(target, node_target)));
  VoxelGroups groups;
  groups.count = count;
  groups.group_of.resize(count);
  std::iota(groups.group_of.begin(), groups.group_of.end(), 0U);
  return groups;
}

// Whether any were turned.
bool turn_normals(FitPoints& fit, const VoxelGroups& groups, const Scan& nodes) {
  const std::vector<bool> turned = normals_to_turn(nodes);
  for (std::size_t p = 0; p < fit.scan.normals.size(); ++p) {
    if (turned[groups.group_of[p]]) fit.scan.normals[p] = -fit.scan.normals[p];
  }
  for (const std::uint32_t point : fit.stands_for) {
    if (point != no_point && turned[groups.group_of[point]]) ++fit.turned_normals;
  }
  return fit.turned_normals > 0;
}

void make_nodes(FitPoints& fit) {
  const bool is_mesh = !fit.scan.triangles.empty();
  VoxelGroups groups = groups_for_nodes(fit.scan);
  Scan nodes = middles_of(fit.scan, groups);
  if (!is_mesh && fit.scan.has_normals() && turn_normals(fit, groups, nodes)) {
    groups = groups_for_nodes(fit.scan);
    nodes = middles_of(fit.scan, groups);
  }
  const auto pairs = is_mesh ? pairs_of_mesh(fit.scan, groups.group_of)
                             : without_gaps(fit.scan.points_m, groups, nodes.points_m, pairs_of_cloud(nodes));
  fit.node_of = std::move(groups.group_of);
  fit.node_normals = nodes.has_normals() ? std::move(nodes.normals)
                                         : std::vector<Vector3>(nodes.points_m.size(), Vector3::Zero());
  fit.graph = make_point_graph(std::move(nodes.points_m), pairs);
  fit.rims = is_mesh ? rims_of_mesh(fit.scan.triangles, fit.node_of, fit.graph) : rims_of_cloud(fit.graph);
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
    join(scan);
    fit.joined -= scan.points_m.size();
  }
  fit.given_m = scan.points_m;
  fit.stands_for.resize(fit.given_m.size());
  std::iota(fit.stands_for.begin(), fit.stands_for.end(), 0U);
  std::vector<std::uint32_t> spikes;
  if (is_mesh) {
    if (!(area_of(scan) > 0.0)) return Error{"its triangles have no area"};
    spikes = level_spikes(scan);
    refine(scan);
    fit.weights = take_normals(scan);
  }
  if (scan.points_m.size() < least_points) {
    return Error{"has too few points for a fit: " + std::to_string(scan.points_m.size()) + " of at least " +
                 std::to_string(least_points)};
  }
  if (!(size_of(scan.points_m) > 0.0)) return Error{"its points all lie in one place"};
  if (lie_on_a_line(scan.points_m)) return Error{"its points all lie on one line, which is no surface"};
  thin(scan, fit.weights, fit.stands_for);
  fit.scan = std::move(scan);
  fit.outliers = spikes.size();
  for (const std::uint32_t spike : spikes) fit.stands_for[spike] = no_point;
  if (!is_mesh) {
    keep_only(fit, lie_apart(fit.scan.points_m, fit.weights));
    // A voxel of a dense place counts as much as one of a thin place.
    fit.weights.assign(fit.weights.size(), 1.0);
  }
  make_nodes(fit);
  return fit;
}

std::vector<Vector2> take_points_as_nodes(FitPoints& points, const std::vector<Vector2>& uv) {
  SPOONBILL_ASSERT(uv.size() == points.scan.points_m.size());
  const std::size_t count = points.scan.points_m.size(), stride = 1 + count / (4 * node_target);
  std::vector<Vector3> nodes, places;
  std::vector<Vector2> node_uv;
  for (std::size_t p = 0; p < count; p += stride) {
    nodes.push_back(points.scan.points_m[p]);
    node_uv.push_back(uv[p]);
    places.emplace_back(uv[p].x(), uv[p].y(), 0.0);
  }
  const NearestPoints nearest(places);
  for (std::size_t p = 0; p < count; ++p) {
    points.node_of[p] = nearest.nearest({uv[p].x(), uv[p].y(), 0.0}).index;
  }
  points.node_normals.assign(nodes.size(), Vector3::Zero());
  points.rims.clear();
  points.graph = make_point_graph(std::move(nodes), {});
  return node_uv;
}

void add_spanning_nodes(FitPoints& points, const std::vector<Vector3>& places_m,
                        const std::vector<Vector3>& normals, const std::vector<NodePair>& pairs) {
  SPOONBILL_ASSERT(normals.empty() || normals.size() == places_m.size());
  std::vector<NodePair> all = pairs;
  for (std::uint32_t n = 0; n < points.graph.size(); ++n) {
    for (const std::uint32_t other : points.graph.of(n)) {
      if (other > n) all.emplace_back(n, other);
    }
  }
  std::vector<Vector3> nodes = std::move(points.graph.points_m);
  nodes.insert(nodes.end(), places_m.begin(), places_m.end());
  points.node_normals.insert(points.node_normals.end(), normals.begin(), normals.end());
  points.spanning_nodes += places_m.size();
  points.graph = make_point_graph(std::move(nodes), all);
}

}  // namespace spoonbill
