#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"
#include "loops.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

// Converts the index of a vertex to its parameters (u, v). For a vertex on a seam, unrolled() must then move
// these parameters to the side of the seam on which the triangle is.
struct Vertices {
  const Grid& grid;
  const TrimmedGrid& trimmed;

  Eigen::Vector2d operator[](std::uint32_t number) const {
    const auto samples = static_cast<std::uint32_t>(grid.rows() * grid.columns());
    if (number >= samples)
      return {trimmed.vertices[number - samples].u, trimmed.vertices[number - samples].v};
    const auto columns = static_cast<std::uint32_t>(grid.columns());
    return {grid.u.parameters[number / columns], grid.v.parameters[number % columns]};
  }
};

struct Triangle {
  Eigen::Vector2d corners[3];
  double area() const {
    const Eigen::Vector2d a = corners[1] - corners[0], b = corners[2] - corners[0];
    return 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
};

// Returns the point shifted by whole periods to be beside `near`.
Eigen::Vector2d unrolled(Eigen::Vector2d point, const Grid& grid, const Eigen::Vector2d& near) {
  for (const auto& [axis, knots] : {std::pair{0, &grid.u.knots}, std::pair{1, &grid.v.knots}}) {
    const double period = knots->domain_end() - knots->domain_start();
    if (knots->is_periodic()) point[axis] += period * std::round((near[axis] - point[axis]) / period);
  }
  return point;
}

std::vector<Triangle> triangles_of(const Grid& grid, const TrimmedGrid& trimmed) {
  const Vertices vertices{grid, trimmed};
  std::vector<Triangle> triangles;
  for (const auto& corners : trimmed.triangles) {
    Triangle triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      triangle.corners[c] = unrolled(vertices[corners[c]], grid, vertices[corners[0]]);
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

// Expects the triangles to have the same orientation, to cover the kept area, and to share whole sides except
// along loops and ends of the domain.
void expect_covers(const Grid& grid, const TrimmedArea& area, double cell_diagonal) {
  const TrimmedGrid trimmed = trim_grid(grid.u, grid.v, area);
  double covered = 0.0;
  for (const Triangle& triangle : triangles_of(grid, trimmed)) {
    EXPECT_GE(triangle.area(), -1e-15);
    covered += triangle.area();
    const Eigen::Vector2d middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
    if (triangle.area() > 1e-9) {
      EXPECT_TRUE(area.contains(middle.x(), middle.y())) << middle.transpose();
    }
    EXPECT_LT((triangle.corners[1] - triangle.corners[0]).norm(), cell_diagonal);
  }
  const double domain = (grid.u.knots.domain_end() - grid.u.knots.domain_start()) *
                        (grid.v.knots.domain_end() - grid.v.knots.domain_start());
  // The bound allows for points that are moved by a billionth to a grid line.
  EXPECT_NEAR(covered, area.remaining_fraction() * domain, 1e-8 * domain);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const auto& corners : trimmed.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax(corners[c], corners[(c + 1) % 3]);
      ++sides[{low, high}];
    }
  }
  const Vertices vertices{grid, trimmed};
  for (const auto& [side, count] : sides) {
    EXPECT_LE(count, 2);
    if (count == 2) continue;
    // An edge of a single triangle must be at an end of an open direction or on a loop, because the surface
    // is kept on only one side of a loop.
    const Eigen::Vector2d a = vertices[side.first], b = unrolled(vertices[side.second], grid, a);
    const Eigen::Vector2d middle = 0.5 * (a + b), across(a.y() - b.y(), b.x() - a.x());
    const auto at_end = [&](const KnotVector& knots, double parameter) {
      return !knots.is_periodic() && (parameter == knots.domain_start() || parameter == knots.domain_end());
    };
    if (at_end(grid.u.knots, middle.x()) || at_end(grid.v.knots, middle.y())) continue;
    const Eigen::Vector2d step = 1e-7 * across.normalized();
    EXPECT_NE(area.contains(middle.x() + step.x(), middle.y() + step.y()),
              area.contains(middle.x() - step.x(), middle.y() - step.y()))
        << "a gap at " << middle.transpose();
  }
}

Grid grid_of(const KnotVector& u, const KnotVector& v, int rows, int columns) {
  const auto parameters = [](const KnotVector& knots, int count) {
    return knots.is_periodic() ? uniform_parameters_without_seam(knots, count)
                               : uniform_parameters(knots, count);
  };
  return make_grid(u, v, parameters(u, rows), parameters(v, columns)).value();
}

TEST(TrimmedGrid, CoversWhatIsKeptWithoutGapsWhateverTheGrid) {
  const TrimLoop outer = round_loop(open_u, open_v, {1.0, 0.0}, 0.98, 7, false);
  const TrimLoop hole = round_loop(open_u, open_v, {1.2, 0.1}, 0.3, 5, true);
  const TrimLoop slot = polygon_loop(open_u, open_v, backwards(rectangle(0.4, -0.3, 0.7, 0.35)));
  const TrimmedArea area = TrimmedArea::make(open_u, open_v, {outer, hole, slot}).value();
  for (const auto& [rows, columns] : {std::pair{2, 2}, {3, 2}, {5, 9}, {16, 11}, {41, 41}}) {
    SCOPED_TRACE(rows);
    expect_covers(grid_of(open_u, open_v, rows, columns), area, 4.0 / (std::min(rows, columns) - 1));
  }
}

TEST(TrimmedGrid, TakesLoopsThatLieOnGridLines) {
  // The grid lines are at multiples of a quarter in u and v. So are the corners of the loops, most of their
  // sides and the ends of the domain.
  const Grid grid = grid_of(open_u, open_v, 9, 9);
  const std::vector<std::vector<TrimLoop>> cases = {
      {polygon_loop(open_u, open_v, rectangle(0, -1, 2, 1))},
      {polygon_loop(open_u, open_v, rectangle(0.5, -0.5, 1.5, 0.25))},
      {polygon_loop(open_u, open_v, backwards(rectangle(0.5, -0.5, 1.5, 0.25)))},
      {polygon_loop(open_u, open_v, {{1.0, -0.5}, {1.5, 0.0}, {1.0, 0.5}, {0.5, 0.0}})},
      {polygon_loop(open_u, open_v, {{0.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}})},
      {polygon_loop(open_u, open_v, rectangle(0, -1, 1, 1)),
       polygon_loop(open_u, open_v, rectangle(1, -1, 2, 0))}};
  for (const auto& loops : cases) {
    const auto area = TrimmedArea::make(open_u, open_v, loops);
    ASSERT_TRUE(area.ok()) << area.error().message;
    expect_covers(grid, area.value(), 1.0);
  }
}

TEST(TrimmedGrid, ClosesOverSeams) {
  for (const double middle : {0.0, 0.47, 0.97}) {
    const TrimmedArea tube =
        TrimmedArea::make(periodic_u, open_v, {round_loop(periodic_u, open_v, {middle, 0.2}, 0.2, 6, true)})
            .value();
    expect_covers(grid_of(periodic_u, open_v, 7, 5), tube, 1.0);
    const TrimmedArea torus =
        TrimmedArea::make(periodic_u, periodic_u,
                          {round_loop(periodic_u, periodic_u, {middle, middle}, 0.2, 6, true)})
            .value();
    expect_covers(grid_of(periodic_u, periodic_u, 7, 6), torus, 1.0);
  }
  // This grid has samples at both ends of the period, so it contains the seam twice.
  const TrimmedArea tube =
      TrimmedArea::make(periodic_u, open_v,
                        {polygon_loop(periodic_u, open_v, rectangle(0.3, -0.5, 1.3, 0.3))})
          .value();
  expect_covers(grid_of(periodic_u, open_v, 7, 5), tube, 1.0);
  const Grid twice =
      make_grid(periodic_u, open_v, uniform_parameters(periodic_u, 8), uniform_parameters(open_v, 5)).value();
  double covered = 0.0;
  const TrimmedGrid trimmed = trim_grid(twice.u, twice.v, tube);
  for (const Triangle& triangle : triangles_of(twice, trimmed)) covered += std::abs(triangle.area());
  EXPECT_NEAR(covered, 0.8, 1e-8);
}

TEST(TrimmedGrid, CutVerticesLieBetweenTheirCellsCorners) {
  const Grid grid = grid_of(open_u, open_v, 6, 5);
  const TrimmedArea area =
      TrimmedArea::make(open_u, open_v, {round_loop(open_u, open_v, {1.0, 0.0}, 0.7, 7, false)}).value();
  const TrimmedGrid trimmed = trim_grid(grid.u, grid.v, area);
  const Vertices vertices{grid, trimmed};
  ASSERT_GT(trimmed.vertices.size(), 20u);
  for (const CutVertex& cut : trimmed.vertices) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_GE(cut.weights[c], -1e-15);
      mean += cut.weights[c] * vertices[cut.corners[c]];
    }
    // u and v are bilinear in a cell. The bound allows for the rounding of coordinates, whose magnitude is at
    // most 2.
    EXPECT_NEAR((mean - Eigen::Vector2d(cut.u, cut.v)).norm(), 0.0, 1e-14);
  }
}

}  // namespace
}  // namespace spoonbill
