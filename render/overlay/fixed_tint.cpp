#include "render/overlay/fixed_tint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "render/overlay/overlays.h"

namespace spoonbill {
namespace {

// Nodes within this distance of a vertex count, in mean edges along the lattice's coarsest direction.
constexpr double reach_edges = 1.6;

using Cell = std::array<int, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    const auto mixed = [](int value, std::size_t factor) { return static_cast<std::size_t>(value) * factor; };
    return mixed(cell[0], 73856093) ^ mixed(cell[1], 19349663) ^ mixed(cell[2], 83492791);
  }
};

Cell cell_of(const Eigen::Vector3f& point_m, float size_m) {
  constexpr float limit = 1e6f;
  const auto index = [&](float value) {
    const float scaled = std::floor(value / size_m);
    return std::isfinite(scaled) ? static_cast<int>(std::clamp(scaled, -limit, limit)) : 0;
  };
  return {index(point_m.x()), index(point_m.y()), index(point_m.z())};
}

// Nodes of a lattice by cells of `reach_m`.
class NodeCells {
 public:
  NodeCells(const LatticeSnapshot& lattice, float reach_m) : lattice_(&lattice), reach_m_(reach_m) {
    for (std::size_t i = 0; i < lattice.x.size(); ++i) {
      if (lattice.in_body[i] != 0) cells_[cell_of(node(i), reach_m)].push_back(static_cast<std::uint32_t>(i));
    }
  }

  // Returns the share of the fixed ones among the nodes near a point; the nearest count most.
  float fixed_share(const Eigen::Vector3f& point_m) const {
    const Cell centre = cell_of(point_m, reach_m_);
    float sum = 0.0f, fixed = 0.0f;
    for (int k = 0; k < 27; ++k) {
      const auto found =
          cells_.find({centre[0] + k % 3 - 1, centre[1] + k / 3 % 3 - 1, centre[2] + k / 9 - 1});
      if (found == cells_.end()) continue;
      for (const std::uint32_t i : found->second) {
        const float near = std::max(0.0f, 1.0f - (node(i) - point_m).norm() / reach_m_);
        sum += near * near;
        if (lattice_->fixed[i] != 0) fixed += near * near;
      }
    }
    return sum > 0.0f ? fixed / sum : 0.0f;
  }

 private:
  Eigen::Vector3f node(std::size_t i) const { return {lattice_->x[i], lattice_->y[i], lattice_->z[i]}; }

  const LatticeSnapshot* lattice_;
  float reach_m_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

}  // namespace

void FixedTint::update(const LatticeSnapshot& lattice, const TessellatedSurface& surface,
                       bool keeps_weights) {
  const std::size_t count = surface.vertex_count();
  const bool fits = weights_.size() == count && topology_version_ == surface.topology_version();
  if (keeps_weights && fits && fixed_ == lattice.fixed) return;
  topology_version_ = surface.topology_version();
  fixed_ = lattice.fixed;
  weights_.assign(count, 0.0f);
  const auto edges_m = mean_edges_m(lattice);
  const double reach_m = reach_edges * *std::max_element(edges_m.begin(), edges_m.end());
  const bool any = std::find(fixed_.begin(), fixed_.end(), std::uint8_t{1}) != fixed_.end();
  if (!any || !(reach_m > 0.0) || lattice.in_body.size() != lattice.x.size()) return;
  const NodeCells cells(lattice, static_cast<float>(reach_m));
  const GridSamples<float>& samples = surface.samples();
  for (std::size_t v = 0; v < count; ++v) {
    const float share = cells.fixed_share({samples.x[v], samples.y[v], samples.z[v]});
    weights_[v] = std::clamp(2.0f * share - 0.5f, 0.0f, 1.0f);
  }
}

}  // namespace spoonbill
