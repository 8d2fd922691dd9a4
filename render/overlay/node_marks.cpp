#include "render/overlay/node_marks.h"

#include <algorithm>
#include <cstddef>

namespace spoonbill {
namespace {

constexpr float fixed_share = 0.26f, fixed_least_px = 2.3f;
constexpr float touched_share = 0.42f, touched_least_px = 3.2f;
constexpr float lattice_width_px = 0.7f;

std::size_t node_count(const LatticeSnapshot& lattice) {
  return lattice.x.size();
}

Eigen::Vector3f node(const LatticeSnapshot& lattice, std::size_t i) {
  return {lattice.x[i], lattice.y[i], lattice.z[i]};
}

// Node indices grow by this along each of the three directions.
struct Strides {
  std::size_t step[3];
  explicit Strides(const LatticeSnapshot& lattice)
      : step{static_cast<std::size_t>(lattice.count[1]) * static_cast<std::size_t>(lattice.count[2]),
             static_cast<std::size_t>(lattice.count[2]), 1} {}
};

// Calls visit(axis, node, neighbour) for every edge.
template <class Visit>
void for_each_edge(const LatticeSnapshot& lattice, Visit visit) {
  const Strides strides(lattice);
  std::size_t at = 0;
  for (int i = 0; i < lattice.count[0]; ++i) {
    for (int j = 0; j < lattice.count[1]; ++j) {
      for (int k = 0; k < lattice.count[2]; ++k, ++at) {
        const int place[3] = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          if (place[axis] + 1 < lattice.count[axis]) visit(axis, at, at + strides.step[axis]);
        }
      }
    }
  }
}

OverlayMark mark_at(const LatticeSnapshot& lattice, std::size_t i, Colour colour, float radius_m,
                    float least_px, MarkShape shape) {
  return {node(lattice, i), colour, radius_m, least_px, static_cast<float>(shape)};
}

}  // namespace

float mean_edge_m(const LatticeSnapshot& lattice) {
  double length[3] = {0, 0, 0};
  std::size_t edges[3] = {0, 0, 0};
  for_each_edge(lattice, [&](int axis, std::size_t a, std::size_t b) {
    length[axis] += (node(lattice, b) - node(lattice, a)).norm();
    ++edges[axis];
  });
  double shortest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (edges[axis] == 0) continue;
    const double mean = length[axis] / static_cast<double>(edges[axis]);
    if (shortest == 0.0 || mean < shortest) shortest = mean;
  }
  return static_cast<float>(shortest);
}

void append_fixed_marks(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayMark>& marks) {
  const float radius_m = fixed_share * mean_edge_m(lattice);
  for (std::size_t i = 0; i < node_count(lattice); ++i) {
    if (lattice.fixed[i] == 0 || lattice.touched[i] != 0) continue;
    if (!inner && lattice.on_shell[i] == 0) continue;
    marks.push_back(mark_at(lattice, i, palette::fixed_node, radius_m, fixed_least_px, MarkShape::square));
  }
}

void append_touched_marks(const LatticeSnapshot& lattice, std::vector<OverlayMark>& marks) {
  const float radius_m = touched_share * mean_edge_m(lattice);
  for (std::size_t i = 0; i < node_count(lattice); ++i) {
    if (lattice.touched[i] == 0) continue;
    marks.push_back(mark_at(lattice, i, palette::touched_node, radius_m, touched_least_px, MarkShape::disc));
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

}  // namespace spoonbill
