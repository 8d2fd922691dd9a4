#include "render/overlay/cell_lines.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace spoonbill {
namespace {

constexpr float near_width_px = 1.7f, far_width_px = 1.1f;

Eigen::Vector3f node(const LatticeSnapshot& lattice, std::size_t i) {
  return {lattice.x[i], lattice.y[i], lattice.z[i]};
}

struct Edge {
  std::size_t from, to;
  bool is_near;
};

// A quad of the block's hull, its corners in order, and the node inside across from the first.
struct Quad {
  std::array<std::size_t, 4> corners;
  std::size_t inside;
};

bool looks_at(const LatticeSnapshot& lattice, const Quad& quad, const Eigen::Vector3f& eye_m) {
  const auto corner = [&](std::size_t c) { return node(lattice, quad.corners[c]); };
  const Eigen::Vector3f normal = (corner(2) - corner(0)).cross(corner(3) - corner(1));
  const Eigen::Vector3f middle = 0.25f * (corner(0) + corner(1) + corner(2) + corner(3));
  const float outward = normal.dot(corner(0) - node(lattice, quad.inside));
  return normal.dot(eye_m - middle) * outward > 0.0f;
}

// Calls visit(quad) for each of the hull.
template <class Visit>
void visit_hull(const LatticeSnapshot& lattice, const Visit& visit) {
  const std::array<std::size_t, 3> count = {static_cast<std::size_t>(lattice.count[0]),
                                            static_cast<std::size_t>(lattice.count[1]),
                                            static_cast<std::size_t>(lattice.count[2])};
  const std::array<std::size_t, 3> stride = {count[1] * count[2], count[2], 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (const bool high : {false, true}) {
      const std::size_t end = high ? (count[axis] - 1) * stride[axis] : 0;
      for (std::size_t p = 0; p + 1 < count[a]; ++p) {
        for (std::size_t q = 0; q + 1 < count[b]; ++q) {
          const std::size_t first = end + p * stride[a] + q * stride[b];
          visit(Quad{{first, first + stride[a], first + stride[a] + stride[b], first + stride[b]},
                     high ? first - stride[axis] : first + stride[axis]});
        }
      }
    }
  }
}

}  // namespace

void append_cell_lines(const LatticeSnapshot& lattice, const Eigen::Vector3f& eye_m, CellLines& lines) {
  if (*std::min_element(std::begin(lattice.count), std::end(lattice.count)) < 2) return;
  const bool is_box = std::find(lattice.in_body.begin(), lattice.in_body.end(), 0) != lattice.in_body.end();
  std::vector<Edge> edges;
  visit_hull(lattice, [&](const Quad& quad) {
    const bool is_near = is_box || looks_at(lattice, quad, eye_m);
    for (std::size_t c = 0; c < 4; ++c) {
      const auto [low, high] = std::minmax(quad.corners[c], quad.corners[(c + 1) % 4]);
      edges.push_back({low, high, is_near});
    }
  });
  // Of an edge between two faces, the one that looks at the eye.
  std::sort(edges.begin(), edges.end(), [](const Edge& one, const Edge& other) {
    if (one.from != other.from) return one.from < other.from;
    if (one.to != other.to) return one.to < other.to;
    return one.is_near && !other.is_near;
  });
  const auto last = std::unique(edges.begin(), edges.end(), [](const Edge& one, const Edge& other) {
    return one.from == other.from && one.to == other.to;
  });
  edges.erase(last, edges.end());
  for (const Edge& edge : edges) {
    if (lattice.in_body[edge.from] == 0 || lattice.in_body[edge.to] == 0) continue;
    const Colour colour = edge.is_near ? palette::cell_edge : palette::far_cell_edge;
    (edge.is_near ? lines.near : lines.far)
        .push_back({node(lattice, edge.from), node(lattice, edge.to), colour, colour,
                    edge.is_near ? near_width_px : far_width_px});
  }
}

}  // namespace spoonbill
