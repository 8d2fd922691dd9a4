#include "engine/fitting/scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/base/geometry.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {
namespace {

std::uint64_t dominant_axis(const Vector3& normal) {
  if (normal.isZero()) return 6;
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(axis) * 2 + (normal[axis] < 0.0 ? 1 : 0);
}

std::vector<std::uint64_t> voxel_keys(const Scan& scan, double side_m) {
  constexpr double most = (1 << 20) - 1;
  const Vector3 low = box_about(scan.points_m).low;
  std::vector<std::uint64_t> keys(scan.points_m.size());
  for (std::size_t p = 0; p < keys.size(); ++p) {
    std::uint64_t key = scan.has_normals() ? dominant_axis(scan.normals[p]) : 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::clamp((scan.points_m[p][axis] - low[axis]) / side_m, 0.0, most);
      key = key << 20 | static_cast<std::uint64_t>(cell);
    }
    keys[p] = key;
  }
  return keys;
}

}  // namespace

double bounding_diagonal_m(const std::vector<Vector3>& points_m) {
  if (points_m.empty()) return 0.0;
  return box_about(points_m).size();
}

VoxelGroups group_by_voxels(const Scan& scan, double side_m) {
  SPOONBILL_ASSERT(side_m > 0.0);
  const std::vector<std::uint64_t> keys = voxel_keys(scan, side_m);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(keys.size());
  for (std::uint32_t p = 0; p < keys.size(); ++p) order[p] = {keys[p], p};
  std::sort(order.begin(), order.end());
  VoxelGroups groups;
  groups.group_index.resize(keys.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || order[k].first != order[k - 1].first) ++groups.count;
    groups.group_index[order[k].second] = static_cast<std::uint32_t>(groups.count - 1);
  }
  return groups;
}

double voxel_side_for(const Scan& scan, std::size_t groups) {
  SPOONBILL_ASSERT(groups >= 1);
  const double size = bounding_diagonal_m(scan.points_m);
  double side = 1.5 * size / std::sqrt(static_cast<double>(groups));
  // The number of cells that a surface meets is inversely proportional to the square of the cells' side.
  for (int round = 0; round < 12; ++round) {
    const double ratio = static_cast<double>(group_by_voxels(scan, side).count) / static_cast<double>(groups);
    if (ratio > 0.9 && ratio < 1.1) break;
    // Smaller cells give no more groups, because too few positions are distinct.
    if (ratio < 0.9 && side < 1e-4 * size) break;
    side *= std::clamp(std::sqrt(ratio), 0.3, 3.0);
  }
  while (group_by_voxels(scan, side).count > groups + groups / 4) side *= 1.2;
  return side;
}

Scan average_groups(const Scan& scan, const VoxelGroups& groups) {
  SPOONBILL_ASSERT(groups.group_index.size() == scan.points_m.size());
  Scan means;
  means.points_m.assign(groups.count, Vector3::Zero());
  if (scan.has_normals()) means.normals.assign(groups.count, Vector3::Zero());
  std::vector<double> counts(groups.count, 0.0);
  for (std::size_t p = 0; p < scan.points_m.size(); ++p) {
    const std::uint32_t group = groups.group_index[p];
    means.points_m[group] += scan.points_m[p];
    if (scan.has_normals()) means.normals[group] += scan.normals[p];
    counts[group] += 1.0;
  }
  for (std::size_t g = 0; g < groups.count; ++g) means.points_m[g] /= counts[g];
  for (Vector3& normal : means.normals) {
    if (!normal.isZero()) normal.normalize();
  }
  return means;
}

namespace {

constexpr std::size_t neighbours_per_point = 8, plane_neighbours = 16;
// A point is an outlier if the mean distance to its neighbours exceeds the median of these means by more than
// this number of standard deviations. Scanner noise stays within three.
constexpr double outlier_deviations = 6.0;
// Largest spacing of points on a surface, relative to the median spacing. Even an unevenly sampled surface
// has no larger spacing.
constexpr double sparse_spacings = 8.0;
// Largest spread of points across a plane, relative to their spread along it, at which they count as being on
// the plane. Points that fill space have a ratio of about twice this limit.
constexpr double flatness = 0.3;

// Quantiles of values with weights: `counts` holds the number of given points for each value.
class WeightedQuantiles {
 public:
  WeightedQuantiles(const std::vector<double>& values, const std::vector<double>& counts)
      : values_(values), counts_(counts), order_(values.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::sort(order_.begin(), order_.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    total_ = std::accumulate(counts.begin(), counts.end(), 0.0);
  }
  double at(double fraction) const {
    double below = 0.0;
    for (const std::size_t index : order_) {
      below += counts_[index];
      if (below > fraction * (total_ - 1.0)) return values_[index];
    }
    return values_[order_.back()];
  }

 private:
  const std::vector<double>&values_, &counts_;
  std::vector<std::size_t> order_;
  double total_ = 0.0;
};

std::vector<double> mean_neighbour_distances(const std::vector<Vector3>& points_m,
                                             const NearestPoints& nearest) {
  std::vector<NearestPoints::Neighbour> found;
  std::vector<double> reach(points_m.size());
  for (std::size_t p = 0; p < reach.size(); ++p) {
    nearest.nearest(points_m[p], neighbours_per_point + 1, found);
    double sum = 0.0;
    for (const NearestPoints::Neighbour& other : found) sum += other.distance;
    reach[p] = sum / static_cast<double>(neighbours_per_point);
  }
  return reach;
}

std::vector<bool> find_sparse(const std::vector<double>& reach, const std::vector<double>& counts) {
  std::vector<double> spacing(reach.size());
  for (std::size_t p = 0; p < spacing.size(); ++p) spacing[p] = reach[p] / std::sqrt(counts[p]);
  const WeightedQuantiles usual_reach(reach, counts);
  const double median = usual_reach.at(0.5);
  const double longest = median + outlier_deviations * std::max(usual_reach.at(0.84) - median, 0.1 * median);
  const double widest = sparse_spacings * WeightedQuantiles(spacing, counts).at(0.5);
  std::vector<bool> sparse(reach.size());
  for (std::size_t p = 0; p < sparse.size(); ++p) sparse[p] = reach[p] > longest || spacing[p] > widest;
  return sparse;
}

// Returns true if the neighbours spread along a plane that contains the point.
bool is_on_plane(const Vector3& point, const std::vector<Vector3>& points_m,
                 const std::vector<NearestPoints::Neighbour>& found) {
  Vector3 mean = Vector3::Zero();
  for (const NearestPoints::Neighbour& near : found) mean += points_m[near.index];
  mean /= static_cast<double>(found.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const NearestPoints::Neighbour& near : found) {
    const Vector3 offset = points_m[near.index] - mean;
    scatter += offset * offset.transpose() / static_cast<double>(found.size());
  }
  const SymmetricEigen axes = decompose_symmetric(scatter);
  const double along = flatness * std::sqrt(axes.values[1]);
  return std::sqrt(std::max(0.0, axes.values[0])) < along &&
         std::abs(axes.vectors.col(0).dot(point - mean)) < 2.0 * along;
}

// Clears the outlier flag of a point that is on a plane, if at least two thirds of its neighbours are on
// planes or have no outlier flag. Points that fill space can be on a plane by chance, but most of their
// neighbours are not.
void clear_surface_points(const std::vector<Vector3>& points_m, const NearestPoints& nearest,
                          std::vector<bool>& is_outlier) {
  std::vector<NearestPoints::Neighbour> found;
  std::vector<bool> flat(is_outlier.size(), true);
  const auto find_neighbours = [&](std::size_t p) {
    nearest.nearest(points_m[p], plane_neighbours + 1, found);
    std::erase_if(found, [&](const NearestPoints::Neighbour& near) { return near.index == p; });
  };
  for (std::size_t p = 0; p < is_outlier.size(); ++p) {
    if (!is_outlier[p]) continue;
    find_neighbours(p);
    flat[p] = is_on_plane(points_m[p], points_m, found);
  }
  for (std::size_t p = 0; p < is_outlier.size(); ++p) {
    if (!is_outlier[p] || !flat[p]) continue;
    find_neighbours(p);
    const auto around =
        std::count_if(found.begin(), found.end(), [&](const auto& near) { return flat[near.index]; });
    is_outlier[p] = 3 * static_cast<std::size_t>(around) < 2 * found.size();
  }
}

}  // namespace

std::vector<bool> find_outliers(const std::vector<Vector3>& points_m, const std::vector<double>& counts) {
  SPOONBILL_ASSERT(counts.size() == points_m.size());
  const NearestPoints nearest(points_m);
  std::vector<bool> is_outlier = find_sparse(mean_neighbour_distances(points_m, nearest), counts);
  const bool is_thinned = std::any_of(counts.begin(), counts.end(), [](double count) { return count > 1.0; });
  if (is_thinned) clear_surface_points(points_m, nearest, is_outlier);
  return is_outlier;
}

namespace {

// Smallest ratio of the shortest edge at a spike's tip to the mesh's median edge. At the corners of an even
// mesh the ratio is smaller.
constexpr double long_edge_ratio = 3.0;
// Smallest ratio of the shortest edge at a tip to the mean edge of the ring around it. The mean may be large,
// because a few of the ring's edges may lead to neighbouring tips.
constexpr double long_ring_edge_ratio = 1.5;
// Smallest height of a spike relative to the radius of its ring. Tips in an even mesh are lower, since the
// ring around them is wider.
constexpr double least_spike_height = 4.0;
// Limits for the second ring of vertices around a tip, in radii of the first ring. At least a quarter of the
// second ring's vertices must be farther from the first ring's centre than the first limit. At least half of
// them must be nearer to the first ring's plane than the second limit.
constexpr double least_outer_radius = 1.2, most_height = 0.6;
constexpr std::size_t most_measured = 1'000'000;

using VertexRing = std::set<std::uint32_t>;

double length(const Scan& mesh, std::uint32_t a, std::uint32_t b) {
  return (mesh.points_m[b] - mesh.points_m[a]).norm();
}

double median_edge(const Scan& mesh) {
  std::vector<double> lengths;
  const std::size_t stride = 1 + mesh.triangles.size() / most_measured;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += stride) {
    const TriangleCorners& corners = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) lengths.push_back(length(mesh, corners[k], corners[(k + 1) % 3]));
  }
  return median(std::move(lengths));
}

// Returns the vertices whose edges are all long compared with the median edge of the mesh and with the ring
// around the vertex.
std::set<std::uint32_t> find_tips(const Scan& mesh) {
  std::vector<double> shortest(mesh.points_m.size(), std::numeric_limits<double>::infinity());
  std::vector<double> around(mesh.points_m.size(), 0.0), sides(mesh.points_m.size(), 0.0);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[k], to = corners[(k + 1) % 3], opposite = corners[(k + 2) % 3];
      const double edge = length(mesh, from, to);
      shortest[from] = std::min(shortest[from], edge);
      shortest[to] = std::min(shortest[to], edge);
      around[opposite] += edge;
      sides[opposite] += 1.0;
    }
  }
  const double least = long_edge_ratio * median_edge(mesh);
  std::set<std::uint32_t> found;
  for (std::uint32_t vertex = 0; vertex < shortest.size(); ++vertex) {
    const bool is_long =
        shortest[vertex] > least && shortest[vertex] * sides[vertex] > long_ring_edge_ratio * around[vertex];
    if (sides[vertex] > 0.0 && is_long) found.insert(vertex);
  }
  return found;
}

// Returns the neighbours of each of the given vertices.
std::map<std::uint32_t, VertexRing> vertex_rings(const Scan& mesh, const std::set<std::uint32_t>& vertices) {
  std::vector<bool> is_wanted(mesh.points_m.size(), false);
  for (const std::uint32_t vertex : vertices) is_wanted[vertex] = true;
  std::map<std::uint32_t, VertexRing> rings;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_wanted[corners[k]]) continue;
      VertexRing& ring = rings[corners[k]];
      ring.insert(corners[(k + 1) % 3]);
      ring.insert(corners[(k + 2) % 3]);
    }
  }
  return rings;
}

VertexRing difference(const VertexRing& ring, const std::set<std::uint32_t>& others) {
  VertexRing remaining;
  std::set_difference(ring.begin(), ring.end(), others.begin(), others.end(),
                      std::inserter(remaining, remaining.end()));
  return remaining;
}

class RingPlane {
 public:
  // `ring` must have at least three vertices.
  RingPlane(const Scan& mesh, const VertexRing& ring) {
    for (const std::uint32_t vertex : ring) {
      centre += mesh.points_m[vertex] / static_cast<double>(ring.size());
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    std::vector<double> distances;
    for (const std::uint32_t vertex : ring) {
      const Vector3 offset = mesh.points_m[vertex] - centre;
      spread += offset * offset.transpose();
      distances.push_back(offset.norm());
    }
    radius = median(std::move(distances));
    normal_ = decompose_symmetric(spread).vectors.col(0);
  }

  // Returns true if the surface goes on flat around the ring: at least half of the vertices of the second
  // ring, `behind`, are close to this ring's plane, and at least a quarter are farther out than this ring.
  bool is_continued_by(const Scan& mesh, const VertexRing& behind) const {
    std::vector<double> out, off;
    for (const std::uint32_t vertex : behind) {
      const Vector3 offset = mesh.points_m[vertex] - centre;
      off.push_back(std::abs(normal_.dot(offset)));
      out.push_back((offset - normal_.dot(offset) * normal_).norm());
    }
    return quantile(std::move(out), 0.75) > least_outer_radius * radius &&
           median(std::move(off)) < most_height * radius;
  }

  Vector3 centre = Vector3::Zero();
  double radius = 0.0;

 private:
  Vector3 normal_ = Vector3::Zero();
};

}  // namespace

std::vector<std::uint32_t> level_spikes(Scan& mesh) {
  const std::set<std::uint32_t> tips = find_tips(mesh);
  const std::map<std::uint32_t, VertexRing> rings = vertex_rings(mesh, tips);
  std::set<std::uint32_t> at_rings;
  for (const auto& [tip, ring] : rings) at_rings.insert(ring.begin(), ring.end());
  const std::map<std::uint32_t, VertexRing> next_rings = vertex_rings(mesh, at_rings);
  std::vector<std::pair<std::uint32_t, Vector3>> levelled;
  for (const auto& [tip, whole_ring] : rings) {
    const VertexRing ring = difference(whole_ring, tips);
    if (ring.size() < 3) continue;
    const RingPlane plane(mesh, ring);
    const double height = (mesh.points_m[tip] - plane.centre).norm();
    if (!(height > least_spike_height * plane.radius)) continue;
    VertexRing behind;
    for (const std::uint32_t vertex : ring) {
      const VertexRing& next = next_rings.at(vertex);
      behind.insert(next.begin(), next.end());
    }
    behind = difference(difference(behind, tips), ring);
    if (!behind.empty() && plane.is_continued_by(mesh, behind)) levelled.emplace_back(tip, plane.centre);
  }
  std::vector<std::uint32_t> moved;
  for (const auto& [tip, centre] : levelled) {
    mesh.points_m[tip] = centre;
    moved.push_back(tip);
  }
  return moved;
}

namespace {

// Splits triangles at the midpoints of their long edges.
class EdgeSplitter {
 public:
  EdgeSplitter(std::vector<Vector3>& points_m, double longest_m)
      : points_m_(&points_m), longest_m_(longest_m) {}

  void split(const TriangleCorners& t, std::vector<TriangleCorners>& pieces) {
    std::array<std::uint32_t, 3> midpoint{};
    std::array<bool, 3> is_split{};
    for (std::size_t k = 0; k < 3; ++k) is_split[k] = find_midpoint(t[k], t[(k + 1) % 3], midpoint[k]);
    const auto split_count = std::count(is_split.begin(), is_split.end(), true);
    if (split_count == 0) pieces.push_back(t);
    if (split_count == 3) {
      pieces.push_back({midpoint[0], midpoint[1], midpoint[2]});
      for (std::size_t k = 0; k < 3; ++k) pieces.push_back({t[k], midpoint[k], midpoint[(k + 2) % 3]});
    }
    if (split_count != 1 && split_count != 2) return;
    // Starts at the split edge if there is only one, otherwise at the edge after the one that is not split.
    std::size_t k = 0;
    while (split_count == 1 ? !is_split[k] : is_split[(k + 2) % 3]) ++k;
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], m = midpoint[k];
    pieces.push_back({m, b, split_count == 1 ? c : midpoint[(k + 1) % 3]});
    if (split_count == 1) {
      pieces.push_back({a, m, c});
    } else {
      pieces.push_back({a, m, midpoint[(k + 1) % 3]});
      pieces.push_back({a, midpoint[(k + 1) % 3], c});
    }
  }

 private:
  bool find_midpoint(std::uint32_t a, std::uint32_t b, std::uint32_t& midpoint) {
    if (((*points_m_)[a] - (*points_m_)[b]).norm() <= longest_m_) return false;
    const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    const auto [entry, is_new] = midpoints_.try_emplace(key, static_cast<std::uint32_t>(points_m_->size()));
    if (is_new) points_m_->push_back(0.5 * ((*points_m_)[a] + (*points_m_)[b]));
    midpoint = entry->second;
    return true;
  }

  std::vector<Vector3>* points_m_;
  double longest_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> midpoints_;
};

}  // namespace

void split_long_edges(std::vector<Vector3>& points_m, std::vector<TriangleCorners>& triangles,
                      double longest_m, std::size_t triangle_limit) {
  SPOONBILL_ASSERT(longest_m > 0.0);
  for (int round = 0; round < 16 && triangles.size() < triangle_limit; ++round) {
    EdgeSplitter splitter(points_m, longest_m);
    std::vector<TriangleCorners> pieces;
    for (const TriangleCorners& corners : triangles) splitter.split(corners, pieces);
    const bool is_done = pieces.size() == triangles.size();
    triangles = std::move(pieces);
    if (is_done) break;
  }
}

}  // namespace spoonbill
