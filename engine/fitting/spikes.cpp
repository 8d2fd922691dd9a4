#include "engine/fitting/spikes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "engine/fitting/quantiles.h"

namespace spoonbill {
namespace {

// Of the median length of an edge, the shortest one to a tip; a corner of an even mesh has shorter ones.
constexpr double long_edges = 3.0;
// Of the mean side of the ring, of which a few go to tips beside it: the same.
constexpr double long_sides = 1.5;
// Of the ring's radius: above any tip that an even mesh can show, whose next ring is wider.
constexpr double least_height = 4.0;
// Of the ring's radius: how far out the vertices behind it lie, and how near to its plane.
constexpr double goes_on = 1.2, lies_flat = 0.6;
constexpr std::size_t most_measured = 1'000'000;

using VertexRing = std::set<std::uint32_t>;

double length(const Scan& mesh, std::uint32_t a, std::uint32_t b) {
  return (mesh.points_m[b] - mesh.points_m[a]).norm();
}

double usual_edge(const Scan& mesh) {
  std::vector<double> lengths;
  const std::size_t stride = 1 + mesh.triangles.size() / most_measured;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += stride) {
    const TriangleCorners& corners = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) lengths.push_back(length(mesh, corners[k], corners[(k + 1) % 3]));
  }
  return median_of(std::move(lengths));
}

// All of whose edges are long, beside what is usual and beside the ring about it. A vertex without any is
// none.
std::set<std::uint32_t> stand_out(const Scan& mesh) {
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
  const double least = long_edges * usual_edge(mesh);
  std::set<std::uint32_t> found;
  for (std::uint32_t vertex = 0; vertex < shortest.size(); ++vertex) {
    const bool is_long =
        shortest[vertex] > least && shortest[vertex] * sides[vertex] > long_sides * around[vertex];
    if (sides[vertex] > 0.0 && is_long) found.insert(vertex);
  }
  return found;
}

// Of each of these vertices, those that it has an edge with.
std::map<std::uint32_t, VertexRing> rings_of(const Scan& mesh, const std::set<std::uint32_t>& vertices) {
  std::vector<bool> is_asked(mesh.points_m.size(), false);
  for (const std::uint32_t vertex : vertices) is_asked[vertex] = true;
  std::map<std::uint32_t, VertexRing> rings;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_asked[corners[k]]) continue;
      VertexRing& ring = rings[corners[k]];
      ring.insert(corners[(k + 1) % 3]);
      ring.insert(corners[(k + 2) % 3]);
    }
  }
  return rings;
}

VertexRing without(const VertexRing& ring, const std::set<std::uint32_t>& others) {
  VertexRing left;
  std::set_difference(ring.begin(), ring.end(), others.begin(), others.end(),
                      std::inserter(left, left.end()));
  return left;
}

class Place {
 public:
  // Of at least three vertices.
  Place(const Scan& mesh, const VertexRing& ring) {
    for (const std::uint32_t vertex : ring) {
      middle += mesh.points_m[vertex] / static_cast<double>(ring.size());
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    std::vector<double> ways;
    for (const std::uint32_t vertex : ring) {
      const Vector3 way = mesh.points_m[vertex] - middle;
      spread += way * way.transpose();
      ways.push_back(way.norm());
    }
    radius = median_of(std::move(ways));
    normal_ = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  }

  // Whether these are farther out along the ring's plane, on its longer sides at least where it is stretched.
  bool goes_on_in(const Scan& mesh, const VertexRing& behind) const {
    std::vector<double> out, off;
    for (const std::uint32_t vertex : behind) {
      const Vector3 way = mesh.points_m[vertex] - middle;
      off.push_back(std::abs(normal_.dot(way)));
      out.push_back((way - normal_.dot(way) * normal_).norm());
    }
    return quantile_of(std::move(out), 0.75) > goes_on * radius &&
           median_of(std::move(off)) < lies_flat * radius;
  }

  Vector3 middle = Vector3::Zero();
  double radius = 0.0;

 private:
  Vector3 normal_ = Vector3::Zero();
};

}  // namespace

std::vector<std::uint32_t> level_spikes(Scan& mesh) {
  const std::set<std::uint32_t> tips = stand_out(mesh);
  const std::map<std::uint32_t, VertexRing> rings = rings_of(mesh, tips);
  std::set<std::uint32_t> at_rings;
  for (const auto& [tip, ring] : rings) at_rings.insert(ring.begin(), ring.end());
  const std::map<std::uint32_t, VertexRing> next_rings = rings_of(mesh, at_rings);
  std::vector<std::pair<std::uint32_t, Vector3>> levelled;
  for (const auto& [tip, whole_ring] : rings) {
    const VertexRing ring = without(whole_ring, tips);
    if (ring.size() < 3) continue;
    const Place place(mesh, ring);
    const double height = (mesh.points_m[tip] - place.middle).norm();
    if (!(height > least_height * place.radius)) continue;
    VertexRing behind;
    for (const std::uint32_t vertex : ring) {
      const VertexRing& next = next_rings.at(vertex);
      behind.insert(next.begin(), next.end());
    }
    behind = without(without(behind, tips), ring);
    if (!behind.empty() && place.goes_on_in(mesh, behind)) levelled.emplace_back(tip, place.middle);
  }
  std::vector<std::uint32_t> moved;
  for (const auto& [tip, middle] : levelled) {
    mesh.points_m[tip] = middle;
    moved.push_back(tip);
  }
  return moved;
}

}  // namespace spoonbill
