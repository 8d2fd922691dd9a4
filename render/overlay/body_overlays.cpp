#include <algorithm>
#include <array>
#include <cstddef>

#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

constexpr float fixed_fraction = 0.26f, fixed_minimum_px = 2.3f;
constexpr float touched_fraction = 0.42f, touched_minimum_px = 3.2f;
constexpr float lattice_width_px = 0.7f;

std::size_t node_count(const LatticeSnapshot& lattice) {
  return lattice.x.size();
}

Eigen::Vector3f node(const LatticeSnapshot& lattice, std::size_t i) {
  return {lattice.x[i], lattice.y[i], lattice.z[i]};
}

// Increments of the node index along the three directions of the lattice.
struct Strides {
  std::size_t step[3];
  explicit Strides(const LatticeSnapshot& lattice)
      : step{static_cast<std::size_t>(lattice.count[1]) * static_cast<std::size_t>(lattice.count[2]),
             static_cast<std::size_t>(lattice.count[2]), 1} {}
};

// Calls visit(axis, node, neighbour) for every edge of the lattice.
template <class Visit>
void for_each_edge(const LatticeSnapshot& lattice, Visit visit) {
  const Strides strides(lattice);
  std::size_t at = 0;
  for (int i = 0; i < lattice.count[0]; ++i) {
    for (int j = 0; j < lattice.count[1]; ++j) {
      for (int k = 0; k < lattice.count[2]; ++k, ++at) {
        const int position[3] = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          if (position[axis] + 1 < lattice.count[axis]) visit(axis, at, at + strides.step[axis]);
        }
      }
    }
  }
}

OverlayMark mark_at(const LatticeSnapshot& lattice, std::size_t i, Colour colour, float radius_m,
                    float minimum_px, MarkShape shape) {
  return {node(lattice, i), colour, radius_m, minimum_px, static_cast<float>(shape)};
}

constexpr float near_width_px = 1.7f, far_width_px = 1.1f;

struct Edge {
  std::size_t from, to;
  bool is_near;
};

// A quad on the outside of the hexahedral block: its corners in order, and the node one step inwards from the
// first corner.
struct Quad {
  std::array<std::size_t, 4> corners;
  std::size_t inside;
};

bool faces_eye(const LatticeSnapshot& lattice, const Quad& quad, const Eigen::Vector3f& eye_m) {
  const auto corner = [&](std::size_t c) { return node(lattice, quad.corners[c]); };
  const Eigen::Vector3f normal = (corner(2) - corner(0)).cross(corner(3) - corner(1));
  const Eigen::Vector3f centre = 0.25f * (corner(0) + corner(1) + corner(2) + corner(3));
  const float outward = normal.dot(corner(0) - node(lattice, quad.inside));
  return normal.dot(eye_m - centre) * outward > 0.0f;
}

// Calls visit(quad) for each quad on the outside of the block.
template <class Visit>
void visit_boundary(const LatticeSnapshot& lattice, const Visit& visit) {
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

constexpr float net_width_px = 1.1f;

// Radius in metres of the diamonds at control points. A radius of 0 makes their size on the screen constant.
constexpr float net_radius_m = 0.0f;
constexpr float net_radius_px = 2.0f;

}  // namespace

std::array<double, 3> mean_edges_m(const LatticeSnapshot& lattice) {
  std::array<double, 3> length{};
  std::array<std::size_t, 3> edges{};
  for_each_edge(lattice, [&](int axis, std::size_t a, std::size_t b) {
    length[axis] += (node(lattice, b) - node(lattice, a)).norm();
    ++edges[axis];
  });
  for (int axis = 0; axis < 3; ++axis) length[axis] /= std::max<std::size_t>(edges[axis], 1);
  return length;
}

float mean_edge_m(const LatticeSnapshot& lattice) {
  double shortest = 0.0;
  for (const double mean : mean_edges_m(lattice)) {
    if (mean > 0.0 && (shortest == 0.0 || mean < shortest)) shortest = mean;
  }
  return static_cast<float>(shortest);
}

void append_fixed_marks(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayMark>& marks) {
  const float radius_m = fixed_fraction * mean_edge_m(lattice);
  for (std::size_t i = 0; i < node_count(lattice); ++i) {
    if (lattice.fixed[i] == 0 || lattice.touched[i] != 0) continue;
    if (!inner && lattice.on_shell[i] == 0) continue;
    marks.push_back(mark_at(lattice, i, palette::fixed_node, radius_m, fixed_minimum_px, MarkShape::square));
  }
}

void append_touched_marks(const LatticeSnapshot& lattice, std::vector<OverlayMark>& marks) {
  const float radius_m = touched_fraction * mean_edge_m(lattice);
  for (std::size_t i = 0; i < node_count(lattice); ++i) {
    if (lattice.touched[i] == 0) continue;
    marks.push_back(
        mark_at(lattice, i, palette::touched_node, radius_m, touched_minimum_px, MarkShape::disc));
  }
}

void append_lattice_lines(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayLine>& lines) {
  for_each_edge(lattice, [&](int, std::size_t a, std::size_t b) {
    if (lattice.in_body[a] == 0 || lattice.in_body[b] == 0) return;
    if (!inner && (lattice.on_shell[a] == 0 || lattice.on_shell[b] == 0)) return;
    lines.push_back(
        {node(lattice, a), node(lattice, b), palette::lattice, palette::lattice, lattice_width_px});
  });
}

void append_cell_lines(const LatticeSnapshot& lattice, const Eigen::Vector3f& eye_m, CellLines& lines) {
  if (*std::min_element(std::begin(lattice.count), std::end(lattice.count)) < 2) return;
  const bool is_box = std::find(lattice.in_body.begin(), lattice.in_body.end(), 0) != lattice.in_body.end();
  std::vector<Edge> edges;
  visit_boundary(lattice, [&](const Quad& quad) {
    const bool is_near = is_box || faces_eye(lattice, quad, eye_m);
    for (std::size_t c = 0; c < 4; ++c) {
      const auto [low, high] = std::minmax(quad.corners[c], quad.corners[(c + 1) % 4]);
      edges.push_back({low, high, is_near});
    }
  });
  // If an edge occurs both as near and as far, the near entry is sorted first and is kept.
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

void append_control_net(const SurfaceSnapshot& surface, std::vector<OverlayLine>& lines,
                        std::vector<OverlayMark>& marks) {
  const int rows = surface.u.control_point_count(), columns = surface.v.control_point_count();
  const auto point = [&](int i, int j) {
    const auto at = static_cast<std::size_t>((i % rows) * columns + j % columns);
    return Eigen::Vector3f(surface.x[at], surface.y[at], surface.z[at]);
  };
  const auto join = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    lines.push_back({a, b, palette::control_net, palette::control_net, net_width_px});
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      if (i + 1 < rows || surface.u.is_periodic()) join(point(i, j), point(i + 1, j));
      if (j + 1 < columns || surface.v.is_periodic()) join(point(i, j), point(i, j + 1));
      marks.push_back({point(i, j), palette::control_net, net_radius_m, net_radius_px,
                       static_cast<float>(MarkShape::diamond)});
    }
  }
}

void append_reach_ring(const ReachRing& ring, std::vector<OverlayLine>& lines) {
  constexpr float width_px = 2.0f;
  const auto& ends_m = ring.ends_m();
  for (std::size_t k = 0; k < ends_m.size(); ++k) {
    const auto &from = ends_m[k], &to = ends_m[(k + 1) % ends_m.size()];
    if (!from || !to) continue;
    lines.push_back({from->cast<float>(), to->cast<float>(), palette::tool, palette::tool, width_px});
  }
}

}  // namespace spoonbill
