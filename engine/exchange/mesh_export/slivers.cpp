#include "engine/exchange/mesh_export/slivers.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <vector>

namespace spoonbill {
namespace {

constexpr double lowest_m = 1e-9;
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

bool is_gone(const TriangleCorners& corners) {
  return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

double length_m(const TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  return (mesh.vertices_m[a] - mesh.vertices_m[b]).norm();
}

bool is_low(const TriangleMesh& mesh, const TriangleCorners& corners) {
  const Vector3 &a = mesh.vertices_m[corners[0]], &b = mesh.vertices_m[corners[1]],
                &c = mesh.vertices_m[corners[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return (b - a).cross(c - a).norm() <= lowest_m * longest;
}

// Its first two are the ends of its longest edge.
TriangleCorners longest_first(const TriangleMesh& mesh, TriangleCorners corners) {
  const double first = length_m(mesh, corners[0], corners[1]),
               second = length_m(mesh, corners[1], corners[2]),
               third = length_m(mesh, corners[2], corners[0]);
  const int turns = first >= second && first >= third ? 0 : second >= third ? 1 : 2;
  std::rotate(corners.begin(), corners.begin() + turns, corners.end());
  return corners;
}

void drop_gone(TriangleMesh& mesh) {
  std::erase_if(mesh.triangles, is_gone);
}

void merge_near_corners(TriangleMesh& mesh) {
  std::vector<std::uint32_t> stands_for(mesh.vertices_m.size());
  std::iota(stands_for.begin(), stands_for.end(), 0U);
  const auto root = [&](std::uint32_t vertex) {
    while (stands_for[vertex] != vertex) vertex = stands_for[vertex] = stands_for[stands_for[vertex]];
    return vertex;
  };
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = root(corners[k]), b = root(corners[(k + 1) % 3]);
      if (length_m(mesh, a, b) <= lowest_m) stands_for[std::max(a, b)] = std::min(a, b);
    }
  }
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = root(corner);
  }
  drop_gone(mesh);
}

std::uint32_t apex_of(const TriangleCorners& corners, std::uint32_t from, std::uint32_t to) {
  for (const std::uint32_t corner : corners) {
    if (corner != from && corner != to) return corner;
  }
  return from;
}

class Flipping {
 public:
  explicit Flipping(TriangleMesh& mesh) : mesh_(mesh) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (is_low(mesh, mesh.triangles[t])) waiting_.push_back(t);
    }
    if (waiting_.empty()) return;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) own_edges(t);
  }

  // One whose neighbour is another waits until that is gone, or nothing else happens.
  void run() {
    const std::size_t most_flips = flips_per_sliver * waiting_.size();
    std::size_t idle = 0, flips = 0;
    while (!waiting_.empty() && idle < waiting_.size() && flips < most_flips) {
      const std::size_t t = waiting_.front();
      waiting_.pop_front();
      if (resolve(t)) {
        ++flips;
        idle = 0;
      } else {
        waiting_.push_back(t);
        ++idle;
      }
    }
  }

 private:
  static constexpr std::size_t flips_per_sliver = 8;

  static std::uint64_t key(std::uint32_t from, std::uint32_t to) { return (std::uint64_t{from} << 32U) | to; }
  std::size_t owner(std::uint32_t from, std::uint32_t to) const {
    const auto found = owner_.find(key(from, to));
    return found == owner_.end() ? none : found->second;
  }
  void own_edges(std::size_t t) {
    const TriangleCorners& corners = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) owner_[key(corners[k], corners[(k + 1) % 3])] = t;
  }
  void give_up_edges(std::size_t t) {
    const TriangleCorners& corners = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) owner_.erase(key(corners[k], corners[(k + 1) % 3]));
  }
  void replace(std::size_t t, const TriangleCorners& corners) {
    mesh_.triangles[t] = corners;
    own_edges(t);
    if (is_low(mesh_, corners)) waiting_.push_back(t);
  }

  // At a rim a sliver just goes: what its other edges border on becomes the rim.
  bool resolve(std::size_t t) {
    if (!is_low(mesh_, mesh_.triangles[t]) || is_gone(mesh_.triangles[t])) return true;
    const auto [p, q, middle] = longest_first(mesh_, mesh_.triangles[t]);
    const std::size_t beyond = owner(q, p);
    if (beyond == none) {
      give_up_edges(t);
      mesh_.triangles[t] = {p, p, p};
      return true;
    }
    const std::uint32_t apex = apex_of(mesh_.triangles[beyond], p, q);
    const bool is_taken = owner(middle, apex) != none || owner(apex, middle) != none;
    if (apex == middle || is_taken || is_low(mesh_, mesh_.triangles[beyond])) return false;
    give_up_edges(t);
    give_up_edges(beyond);
    replace(t, {middle, p, apex});
    replace(beyond, {apex, q, middle});
    return true;
  }

  TriangleMesh& mesh_;
  std::deque<std::size_t> waiting_;
  std::unordered_map<std::uint64_t, std::size_t> owner_;  // the triangle that runs along an edge that way
};

void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> place(mesh.vertices_m.size(), 0);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) place[corner] = 1;
  }
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == 0) continue;
    mesh.vertices_m[count] = mesh.vertices_m[v];
    place[v] = count++;
  }
  mesh.vertices_m.resize(count);
  for (TriangleCorners& corners : mesh.triangles) {
    for (std::uint32_t& corner : corners) corner = place[corner];
  }
}

}  // namespace

void remove_slivers(TriangleMesh& mesh) {
  merge_near_corners(mesh);
  Flipping(mesh).run();
  drop_gone(mesh);
  drop_unused_vertices(mesh);
}

}  // namespace spoonbill
