#include "engine/material/lattice/feature_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "engine/base/assert.h"
#include "engine/collision/solids/exponential.h"

namespace spoonbill {
namespace {

constexpr int draws_per_report = 4096;
// Radius of the neighbourhood that is updated, relative to the width of its Gaussian. Nodes beyond it would
// move by less than a ninetieth of the nearest node's move.
constexpr double neighbourhood_reach = 3.0;
// A node's move is halved up to `grid_halvings` times before it is rejected. All nodes are moved in `passes`
// passes.
constexpr int grid_halvings = 4, passes = 3;

// Calls visit(node of the first corner, cell) for each cell.
template <class Visit>
void visit_cells(const LatticeMesh& mesh, const Visit& visit) {
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) visit(mesh.index(i, j, k), mesh.cell(i, j, k));
    }
  }
}

// Random points with a uniform density in a body.
class Draws {
 public:
  Draws(const LatticeMesh& mesh, std::uint32_t seed) : random_(seed) {
    visit_cells(mesh, [this](int first, const CellCorners& cell) {
      cells_.push_back({first, cell});
      volumes_.push_back((volumes_.empty() ? 0.0 : volumes_.back()) + cell_volume(cell));
    });
  }

  struct Draw {
    Vector3 point;
    int near;  // a node of the cell from which the point was drawn
  };
  Draw next() {
    const double target = uniform() * volumes_.back();
    const auto cell = std::upper_bound(volumes_.begin(), volumes_.end(), target) - volumes_.begin();
    const auto at = std::min(static_cast<std::size_t>(cell), cells_.size() - 1);
    const double a = uniform(), b = uniform(), c = uniform();
    return {trilinear(cells_[at].corners, a, b, c), cells_[at].first};
  }

 private:
  // Returns a number in [0, 1) made from raw bits, because library distributions differ between
  // implementations.
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  std::mt19937_64 random_;
  struct Cell {
    int first;
    CellCorners corners;
  };
  std::vector<Cell> cells_;
  std::vector<double> volumes_;  // cumulative volumes of the cells
};

class FeatureMap {
 public:
  explicit FeatureMap(const LatticeMesh& mesh) : mesh_(mesh) {
    for (int n = 0; n < mesh.node_count(); ++n) {
      const auto [i, j, k] = mesh.grid_index(n);
      if (mesh.node_location(i, j, k) == NodeLocation::in_body) inside_.push_back(n);
    }
  }

  std::size_t inside_count() const { return inside_.size(); }
  const LatticeMesh& mesh() const { return mesh_; }

  void learn(const Draws::Draw& draw, double rate, double neighbourhood) {
    const Vector3& point = draw.point;
    const std::array<int, 3> winner = nearest(point, mesh_.grid_index(draw.near));
    const int reach = static_cast<int>(neighbourhood_reach * neighbourhood);
    std::array<int, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::max(0, winner[axis] - reach);
      high[axis] = std::min(mesh_.count[axis] - 1, winner[axis] + reach);
    }
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int i = low[0]; i <= high[0]; ++i) {
        for (int j = low[1]; j <= high[1]; ++j) {
          if (mesh_.node_location(i, j, k) != NodeLocation::in_body) continue;
          const double square =
              std::pow(i - winner[0], 2) + std::pow(j - winner[1], 2) + std::pow(k - winner[2], 2);
          Vector3& node = mesh_.nodes[static_cast<std::size_t>(mesh_.index(i, j, k))];
          node += rate * stable_exp(-0.5 * square / (neighbourhood * neighbourhood)) * (point - node);
        }
      }
    }
  }

 private:
  // Returns the node nearest to the point: descends from neighbour to neighbour, which suffices in an ordered
  // grid.
  std::array<int, 3> nearest(const Vector3& point, std::array<int, 3> at) const {
    const auto square_to = [&](const std::array<int, 3>& node) {
      return (mesh_.nodes[static_cast<std::size_t>(mesh_.index(node[0], node[1], node[2]))] - point)
          .squaredNorm();
    };
    double least = square_to(at);
    for (bool nearer = true; nearer;) {
      nearer = false;
      const std::array<int, 3> from = at;
      for (int step = 0; step < 27; ++step) {
        const std::array<int, 3> next = {from[0] + step / 9 - 1, from[1] + step / 3 % 3 - 1,
                                         from[2] + step % 3 - 1};
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          inside = inside && next[axis] >= 0 && next[axis] < mesh_.count[axis];
        }
        if (!inside) continue;
        const double square = square_to(next);
        if (!(square < least)) continue;
        least = square;
        at = next;
        nearer = true;
      }
    }
    return at;
  }

  LatticeMesh mesh_;
  std::vector<int> inside_;
};

// Returns the smallest Jacobian ratio of the cells around a node, at most 1.
double worst_around(const LatticeMesh& mesh, const std::array<int, 3>& at) {
  double worst = 1.0;
  for (int c = 0; c < 8; ++c) {
    const CellCorners cell = mesh.cell(at[0] - (c >> 2 & 1), at[1] - (c >> 1 & 1), at[2] - (c & 1));
    worst = std::min(worst, cell_volume(cell) > 0.0 ? smallest_jacobian_ratio(cell) : -1.0);
  }
  return worst;
}

// Moves the nodes towards `targets`, each only so far that no Jacobian ratio around it falls below `worst`.
// Makes several passes, because a node may be able to move further after its neighbours have moved. Returns
// the fraction of the moves that was applied.
double apply_moves(const std::vector<Vector3>& targets, double worst, LatticeMesh& mesh) {
  double requested = 0.0, remaining = 0.0;
  for (std::size_t n = 0; n < targets.size(); ++n) requested += (targets[n] - mesh.nodes[n]).norm();
  for (int pass = 0; pass < passes; ++pass) {
    for (int n = 0; n < mesh.node_count(); ++n) {
      Vector3& node = mesh.nodes[static_cast<std::size_t>(n)];
      const Vector3 before = node, move = targets[static_cast<std::size_t>(n)] - before;
      if (move.isZero(0.0)) continue;
      double fraction = 1.0;
      for (int halving = 0; halving <= grid_halvings; ++halving, fraction *= 0.5) {
        node = before + fraction * move;
        if (worst_around(mesh, mesh.grid_index(n)) >= worst) break;
        node = before;
      }
    }
  }
  for (std::size_t n = 0; n < targets.size(); ++n) remaining += (targets[n] - mesh.nodes[n]).norm();
  return requested > 0.0 ? 1.0 - remaining / requested : 0.0;
}

// Interpolates geometrically from `first` to `last`.
double interpolate(double first, double last, double progress) {
  return first * stable_exp(progress * stable_log(last / first));
}

}  // namespace

CellQuality measure_cell_quality(const LatticeMesh& mesh) {
  CellQuality quality{1.0, 0.0};
  std::vector<double> volumes;
  double sum = 0.0, squares = 0.0;
  visit_cells(mesh, [&](int, const CellCorners& cell) {
    const double volume = cell_volume(cell);
    quality.worst_jacobian =
        std::min(quality.worst_jacobian, volume > 0.0 ? smallest_jacobian_ratio(cell) : -1.0);
    volumes.push_back(volume);
    sum += volume;
  });
  const double mean = sum / static_cast<double>(volumes.size());
  for (const double volume : volumes) squares += (volume - mean) * (volume - mean);
  quality.volume_spread = std::sqrt(squares / static_cast<double>(volumes.size())) / mean;
  return quality;
}

FeatureMapReport order_by_feature_map(LatticeMesh& mesh, const FeatureMapSettings& settings,
                                      const FeatureMapWatch& watch) {
  SPOONBILL_ASSERT(check_feature_map(settings).ok());
  SPOONBILL_ASSERT_DEBUG(check_cells(mesh).ok());
  FeatureMapReport report;
  report.before = report.after = measure_cell_quality(mesh);
  FeatureMap map(mesh);
  Draws draws(mesh, settings.seed);
  const auto count =
      static_cast<std::int64_t>(settings.draws_per_node) * static_cast<std::int64_t>(map.inside_count());
  for (std::int64_t draw = 0; draw < count; ++draw) {
    const double progress = static_cast<double>(draw) / static_cast<double>(count);
    if (draw % draws_per_report == 0 && !watch.progress.report(progress)) return report;
    map.learn(draws.next(), interpolate(settings.first_rate, settings.last_rate, progress),
              interpolate(settings.first_neighbourhood, settings.last_neighbourhood, progress));
  }
  report.applied_fraction = apply_moves(map.mesh().nodes, report.before.worst_jacobian, mesh);
  report.after = measure_cell_quality(mesh);
  watch.progress.report(1.0);
  if (watch.done) watch.done(report);
  return report;
}

}  // namespace spoonbill
