// Tests which samples of a skin bear contacts.
#include "engine/simulation/contact_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "engine/simulation/body_state.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

NestedGrid grid_of(const Surface& surface, int levels) {
  return make_nested_grid(surface.u, surface.v, levels).value();
}

Vector3 point_of(const Surface& surface, const Grid& grid, int sample) {
  return position(surface, grid.u.parameters[static_cast<std::size_t>(sample / grid.columns())],
                  grid.v.parameters[static_cast<std::size_t>(sample % grid.columns())]);
}

std::ptrdiff_t count_skipped(const SkippedSamples& skipped) {
  return std::count(skipped.begin(), skipped.end(), 1);
}

TEST(CrowdedSamples, AreThoseNearOnesThatAreKept) {
  const Surface box = stock_surface(BoxSize{{0.03, 0.015, 0.024}, 0.003});
  const NestedGrid nested = grid_of(box, 2);
  const Grid& grid = nested.grid;
  constexpr double least_m = 1e-3;
  const SkippedSamples skipped = find_crowded_samples(box, grid, least_m);
  ASSERT_EQ(skipped.size(), static_cast<std::size_t>(grid.rows() * grid.columns()));
  EXPECT_GT(count_skipped(skipped), 0);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const int sample = i * grid.columns() + j;
      const bool is_between = i % 2 == 1 || j % 2 == 1;
      double nearest_m = 1.0;
      for (int row = std::max(0, i - 3); row <= std::min(grid.rows() - 1, i + 3); ++row) {
        for (int column = std::max(0, j - 3); column <= std::min(grid.columns() - 1, j + 3); ++column) {
          const int other = row * grid.columns() + column;
          if (other == sample || skipped[static_cast<std::size_t>(other)] != 0) continue;
          nearest_m = std::min(nearest_m, (point_of(box, grid, other) - point_of(box, grid, sample)).norm());
        }
      }
      if (skipped[static_cast<std::size_t>(sample)] != 0) {
        EXPECT_TRUE(is_between && nearest_m < least_m);
      } else if (is_between) {
        EXPECT_GE(nearest_m, least_m);
      }
    }
  }
}

// A sphere of 10 mm turns by 0.02 rad along 0.2 mm; seen from inside, it is hollow.
TEST(BluntSamples, AreThoseOfLargeRadiusOrHollow) {
  const Surface sphere = stock_surface(SphereSize{0.01});
  const NestedGrid nested = grid_of(sphere, 1);
  const auto inner = nested.grid.rows() * (nested.grid.columns() - 2);  // without the poles
  EXPECT_EQ(count_skipped(find_blunt_samples(sphere, nested.grid, 0.195e-3, false)), inner);
  EXPECT_EQ(count_skipped(find_blunt_samples(sphere, nested.grid, 0.205e-3, false)), 0);
  Surface hollow = sphere;
  for (double& x : hollow.net.x) x = -x;
  EXPECT_EQ(count_skipped(find_blunt_samples(hollow, nested.grid, 0.205e-3, false)), inner);
  EXPECT_EQ(count_skipped(find_blunt_samples(hollow, nested.grid, 0.205e-3, true)), 0);
}

// A prism of degree 1 has no curvature, but creases. A crease has the normal of one of its faces.
TEST(BluntSamples, AreNoneAtCreases) {
  ControlNet net(4, 2);
  for (int i = 0; i < 4; ++i) {
    const double x = i == 0 || i == 3 ? -0.01 : 0.01, z = i < 2 ? -0.01 : 0.01;
    for (int j = 0; j < 2; ++j) net.set_point(i, j, {x, 0.02 * j, z});
  }
  const Surface prism =
      make_surface(KnotVector::periodic_uniform(1, 4).value(), KnotVector::clamped_uniform(1, 2).value(), net)
          .value();
  const Grid grid = grid_of(prism, 2).grid;
  const SkippedSamples skipped = find_blunt_samples(prism, grid, 1e-3, true);
  EXPECT_GT(count_skipped(skipped), 0);
  for (int i = 0; i < grid.rows(); i += 4) {
    for (int j = 0; j < grid.columns(); ++j) EXPECT_FALSE(is_skipped(skipped, i * grid.columns() + j));
  }
}

// A sheet ends at its edges, where another body can be cut into.
TEST(BluntSamples, AreNoneAtEdges) {
  const Surface sheet = stock_surface(SheetSize{});
  const Grid grid = grid_of(sheet, 1).grid;
  const SkippedSamples skipped = find_blunt_samples(sheet, grid, 1e-3, true);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const bool is_edge = i == 0 || j == 0 || i == grid.rows() - 1 || j == grid.columns() - 1;
      EXPECT_EQ(skipped[static_cast<std::size_t>(i * grid.columns() + j)], is_edge ? 0 : 1);
    }
  }
}

TEST(ContactSamples, AreDenserInRealTime) {
  Body block;
  block.name = "block";
  block.surface = stock_surface(BoxSize{{0.03, 0.015, 0.024}, 0.003});
  block.material = bundled_material("gelatin-20-1");
  block.lattice.node_budget = 500;
  const auto set = InstructionSet::baseline;
  const BodyState sculpted = make_body_state(block, {}, set).value();
  EXPECT_TRUE(sculpted.mapping().skipped().empty());
  const BodyState tried = make_body_state(block, {}, set, {}, true).value();
  const auto cell_m = static_cast<double>(tried.lattice.cell_size_m());
  EXPECT_LE(find_largest_spacing_m(tried.mapping().rest(), tried.mapping().nested().grid),
            longest_sample_spacing_cells * cell_m);
  EXPECT_GT(count_skipped(tried.mapping().skipped()), 0);
  EXPECT_EQ(tried.mapping().contact_spacing_m(), 2.0 * least_sample_spacing_cells * cell_m);
  EXPECT_GT(find_largest_spacing_m(sculpted.mapping().rest(), sculpted.mapping().nested().grid),
            longest_sample_spacing_cells * cell_m);
}

}  // namespace
}  // namespace spoonbill
