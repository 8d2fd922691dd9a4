#include "engine/collision/proximity/rest_pairs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// The cosine of how far from the opposite of a normal a direction may be to lead into the body.
constexpr double into_body = 0.3;
// Nearer than this, in lattice cells, no body is thick: what was kept in shape pressed onto itself.
constexpr double least_thickness_cells = 0.25;
// Neighbours are told by blocks of the surface, at most so many along each direction.
constexpr int most_blocks_u = 32, most_blocks_v = 64;

std::vector<double> blocks(const KnotVector& knots, int most) {
  const std::vector<double> breaks = knots.breakpoints();
  const int elements = static_cast<int>(breaks.size()) - 1, count = std::min(elements, most);
  std::vector<double> begins;
  for (int k = 0; k <= count; ++k) begins.push_back(breaks[static_cast<std::size_t>(k * elements / count)]);
  return begins;
}

int block_of(const std::vector<double>& begins, double parameter) {
  const auto next = std::upper_bound(begins.begin(), begins.end(), parameter) - begins.begin();
  return std::clamp(static_cast<int>(next) - 1, 0, static_cast<int>(begins.size()) - 2);
}

}  // namespace

RestPairs::RestPairs(const Grid& grid, Surface rest, double cell_m)
    : rest_(std::move(rest)),
      u_(blocks(rest_.u, most_blocks_u)),
      v_(blocks(rest_.v, most_blocks_v)),
      cell_m_(cell_m) {
  SPOONBILL_ASSERT(cell_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(rest_.u == grid.u.knots && rest_.v == grid.v.knots);
  points_.reserve(static_cast<std::size_t>(grid.rows() * grid.columns()));
  for (const double u : grid.u.parameters) {
    for (const double v : grid.v.parameters) points_.push_back(point_at(u, v));
  }
  neighbour_m_ = std::max(neighbour_cells * cell_m, neighbour_thicknesses * thickness(grid.columns()));
  find_neighbours();
}

// Of the triangles between the samples: the volume by the tetrahedra over them.
double RestPairs::thickness(int columns) const {
  double volume = 0.0, area = 0.0;
  const auto add = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    volume += a.dot(b.cross(c)) / 6.0;
    area += 0.5 * (b - a).cross(c - a).norm();
  };
  const Vector3& origin = points_.front().position_m;
  const auto at = [&](int index) -> Vector3 { return points_[index].position_m - origin; };
  for (int k = 0; k + columns + 1 < static_cast<int>(points_.size()); ++k) {
    if (k % columns == columns - 1) continue;
    add(at(k), at(k + columns), at(k + 1));
    add(at(k + columns + 1), at(k + 1), at(k + columns));
  }
  return area > 0.0 ? 2.0 * std::abs(volume) / area : 0.0;
}

RestPairs::RestPoint RestPairs::point_at(double u, double v) const {
  const int across = static_cast<int>(v_.size()) - 1;
  return {position(rest_, u, v), unit_normal(rest_, u, v), block_of(u_, u) * across + block_of(v_, v)};
}

void RestPairs::find_neighbours() {
  for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v_.size(); ++j) {
      middles_.push_back(position(rest_, 0.5 * (u_[i] + u_[i + 1]), 0.5 * (v_[j] + v_[j + 1])));
    }
  }
  const std::size_t count = middles_.size();
  std::vector<double> distances(count);
  neighbours_.assign(count * count, false);
  for (std::size_t block = 0; block < count; ++block) {
    reach_from(static_cast<int>(block), distances);
    for (std::size_t k = 0; k < count; ++k) neighbours_[block * count + k] = distances[k] <= neighbour_m_;
  }
}

// Dijkstra's shortest ways from block to block, as far as neighbours are.
void RestPairs::reach_from(int block, std::vector<double>& distances) const {
  using Way = std::pair<double, int>;
  std::priority_queue<Way, std::vector<Way>, std::greater<>> ways;
  std::fill(distances.begin(), distances.end(), std::numeric_limits<double>::infinity());
  const int rows = static_cast<int>(u_.size()) - 1, columns = static_cast<int>(v_.size()) - 1;
  const auto offer = [&](int to, double distance) {
    if (distance > neighbour_m_ || distance >= distances[to]) return;
    distances[to] = distance;
    ways.push({distance, to});
  };
  offer(block, 0.0);
  while (!ways.empty()) {
    const auto [distance, at] = ways.top();
    ways.pop();
    if (distance > distances[at]) continue;
    const int i = at / columns, j = at % columns;
    for (int row = i - 1; row <= i + 1; ++row) {
      if (!rest_.u.is_periodic() && (row < 0 || row >= rows)) continue;
      for (int column = j - 1; column <= j + 1; ++column) {
        if (!rest_.v.is_periodic() && (column < 0 || column >= columns)) continue;
        const int to = (row + rows) % rows * columns + (column + columns) % columns;
        offer(to, distance + step_between(at, to));
      }
    }
    // Across a pole.
    if (rest_.v.is_periodic() || (j != 0 && j != columns - 1)) continue;
    for (int row = 0; row < rows; ++row) {
      offer(row * columns + j, distance + step_between(at, row * columns + j));
    }
  }
}

double RestPairs::step_between(int block, int other) const {
  return (middles_[block] - middles_[other]).norm();
}

bool RestPairs::can_meet(double u, double v, double other_u, double other_v) const {
  return can_meet(point_at(u, v), point_at(other_u, other_v));
}

bool RestPairs::can_meet(const RestPoint& one, const RestPoint& other) const {
  const Vector3 between = other.position_m - one.position_m;
  const double distance = between.norm();
  if (distance > through_body * neighbour_m_) return true;
  const double enough = -into_body * distance;
  const bool inward = between.dot(one.normal) < enough && -between.dot(other.normal) < enough;
  if (inward && distance > least_thickness_cells * cell_m_) return false;
  if (distance > neighbour_m_) return true;
  return !neighbours_[static_cast<std::size_t>(one.block) * middles_.size() +
                      static_cast<std::size_t>(other.block)];
}

}  // namespace spoonbill
