#include "engine/simulation/contact_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Largest angle by which a blunt surface turns from one sample of a soft body to the next, rad. On surfaces
// that bulge more, soft bodies that hit them at a metre a second sink in deeper without these samples.
constexpr double blunt_turn = 0.02;

std::vector<Vector3> find_points_m(const Surface& surface, const Grid& grid) {
  std::vector<Vector3> points_m;
  points_m.reserve(static_cast<std::size_t>(grid.rows() * grid.columns()));
  for (const double u : grid.u.parameters) {
    for (const double v : grid.v.parameters) points_m.push_back(position(surface, u, v));
  }
  return points_m;
}

// Calls visit(row, column) for the samples up to `reach` rows and columns from one.
template <class Visit>
void visit_around(const Grid& grid, int row, int column, int reach, const Visit& visit) {
  for (int i = std::max(0, row - reach); i <= std::min(grid.rows() - 1, row + reach); ++i) {
    for (int j = std::max(0, column - reach); j <= std::min(grid.columns() - 1, column + reach); ++j) {
      visit(i, j);
    }
  }
}

bool is_at_edge(const KnotVector& knots, int index, int count) {
  return !knots.is_periodic() && (index == 0 || index == count - 1);
}

}  // namespace

double find_largest_spacing_m(const Surface& surface, const Grid& grid) {
  const std::vector<Vector3> points_m = find_points_m(surface, grid);
  const auto at = [&](int i, int j) { return points_m[static_cast<std::size_t>(i * grid.columns() + j)]; };
  double largest_m = 0.0;
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      if (i + 1 < grid.rows()) largest_m = std::max(largest_m, (at(i + 1, j) - at(i, j)).norm());
      if (j + 1 < grid.columns()) largest_m = std::max(largest_m, (at(i, j + 1) - at(i, j)).norm());
    }
  }
  return largest_m;
}

namespace {

SkippedSamples without_zeros(SkippedSamples skipped) {
  return std::any_of(skipped.begin(), skipped.end(), [](std::uint8_t skip) { return skip != 0; })
             ? std::move(skipped)
             : SkippedSamples();
}

}  // namespace

SkippedSamples find_crowded_samples(const Surface& surface, const Grid& grid, double least_m) {
  SPOONBILL_ASSERT(least_m > 0.0);
  constexpr int reach = 3;
  const std::vector<Vector3> points_m = find_points_m(surface, grid);
  SkippedSamples skipped(points_m.size(), 1);
  const auto index = [&](int i, int j) { return static_cast<std::size_t>(i * grid.columns() + j); };
  for (int i = 0; i < grid.rows(); i += 2) {
    for (int j = 0; j < grid.columns(); j += 2) skipped[index(i, j)] = 0;
  }
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const std::size_t sample = index(i, j);
      if (skipped[sample] == 0) continue;
      bool is_crowded = false;
      visit_around(grid, i, j, reach, [&](int row, int column) {
        const std::size_t other = index(row, column);
        if (skipped[other] == 0 && (points_m[other] - points_m[sample]).norm() < least_m) is_crowded = true;
      });
      if (!is_crowded) skipped[sample] = 0;
    }
  }
  // Samples at the same point, across a seam, are treated alike.
  for (int j = 0; j < grid.columns() && surface.u.is_periodic(); ++j) {
    skipped[index(grid.rows() - 1, j)] = skipped[index(0, j)];
  }
  for (int i = 0; i < grid.rows() && surface.v.is_periodic(); ++i) {
    skipped[index(i, grid.columns() - 1)] = skipped[index(i, 0)];
  }
  return without_zeros(std::move(skipped));
}

SkippedSamples find_blunt_samples(const Surface& surface, const Grid& grid, double spacing_m, bool is_shell) {
  SPOONBILL_ASSERT(spacing_m >= 0.0 && std::isfinite(spacing_m));
  const std::vector<Vector3> points_m = find_points_m(surface, grid);
  std::vector<Vector3> normals;
  normals.reserve(points_m.size());
  for (const double u : grid.u.parameters) {
    for (const double v : grid.v.parameters) normals.push_back(unit_normal(surface, u, v));
  }
  const auto index = [&](int i, int j) { return static_cast<std::size_t>(i * grid.columns() + j); };
  // The normals of a convex arc deviate outward, in the direction of the arc, by its length over its radius.
  const auto turns_little = [&](std::size_t from, std::size_t to) {
    const Vector3 way_m = points_m[to] - points_m[from];
    const double turn_m = (normals[to] - normals[from]).dot(way_m) * spacing_m;
    return (is_shell ? std::abs(turn_m) : turn_m) <= blunt_turn * way_m.squaredNorm();
  };
  SkippedSamples skipped(points_m.size(), 0);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      if (is_at_edge(surface.u, i, grid.rows()) || is_at_edge(surface.v, j, grid.columns())) continue;
      bool is_blunt = true;
      for (const int row : find_neighbours(i, grid.rows(), surface.u.is_periodic()))
        is_blunt = is_blunt && turns_little(index(i, j), index(row, j));
      for (const int column : find_neighbours(j, grid.columns(), surface.v.is_periodic()))
        is_blunt = is_blunt && turns_little(index(i, j), index(i, column));
      skipped[index(i, j)] = is_blunt;
    }
  }
  return without_zeros(std::move(skipped));
}

std::array<int, 2> find_neighbours(int index, int count, bool is_closed) {
  if (is_closed) return {index == 0 ? count - 2 : index - 1, index == count - 1 ? 1 : index + 1};
  return {std::max(index - 1, 0), std::min(index + 1, count - 1)};
}

}  // namespace spoonbill
