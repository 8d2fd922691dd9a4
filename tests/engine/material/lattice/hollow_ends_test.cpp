// Tests lattices of bodies whose poles are at the bottom of hollows, as in pears and apples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/feature_map.h"
#include "tests/engine/effort.h"
#include "tests/engine/material/lattice/revolved.h"

namespace spoonbill {
namespace {

constexpr double fruit_radius_m = 0.036;

// The shape of a fruit in units of its radius: an ellipsoid of revolution with the half length `half_length`,
// whose ends are pressed in at the poles. It narrows towards its upper end.
struct Fruit {
  const char* name;
  double half_length;
  double low_press, low_width, high_press, high_width;
  double thinner;  // fraction of the radius that is missing at the upper end
  double lean;
};

Surface surface_of(const Fruit& fruit) {
  return revolved(
      [&](double share) {
        const double angle = std::numbers::pi * share, up = -std::cos(angle), out = std::sin(angle);
        const double press = up < 0.0 ? fruit.low_press : fruit.high_press,
                     width = up < 0.0 ? fruit.low_width : fruit.high_width;
        const double t = std::clamp(up + 0.3, 0.0, 1.0);
        return MeridianPlace{
            fruit_radius_m * out * (1.0 - fruit.thinner * t * t * (3.0 - 2.0 * t)),
            fruit_radius_m * up * (fruit.half_length - press * std::exp(-std::pow(out / width, 2)))};
      },
      fruit.lean * fruit_radius_m);
}

// Depths of the poles below the highest points around them, in units of the radius.
struct Depths {
  double low, high;
};

Depths depths_of(const Surface& surface) {
  const auto height = [&](double share) {
    return position(surface, surface.u.domain_start(), share * surface.v.domain_end()).z();
  };
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (int s = 0; s <= 400; ++s) {
    lowest = std::min(lowest, height(s / 400.0));
    highest = std::max(highest, height(s / 400.0));
  }
  return {(height(0.0) - lowest) / fruit_radius_m, (highest - height(1.0)) / fruit_radius_m};
}

constexpr Fruit apple{"apple", 0.9, 0.5, 0.4, 0.5, 0.4, 0.0, 0.0};
constexpr Fruit apple_of_narrow_hollows{"narrow", 0.9, 0.4, 0.3, 0.4, 0.3, 0.0, 0.0};
constexpr Fruit apple_of_wide_hollows{"wide", 0.9, 0.6, 0.5, 0.6, 0.5, 0.0, 0.0};
constexpr Fruit flat_apple{"flat apple", 0.9, 0.3, 0.4, 0.35, 0.4, 0.0, 0.0};
constexpr Fruit pear{"pear", 1.3, 0.5, 0.35, 0.4, 0.5, 0.45, 0.0};
// A pear as long and wide as a scanned one of 97 x 72 mm, with as thin a neck and as much lean.
constexpr Fruit leaning_pear{"leaning pear", 1.5, 0.45, 0.35, 0.3, 0.35, 0.5, 0.5};

double smallest_determinant(const CellCorners& cell) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const double inset : {0.0, 0.5 - 0.5 / std::sqrt(3.0)}) {
    for (int c = 0; c < 8; ++c) {
      const auto at = [&](int bit) { return (c & bit) != 0 ? 1.0 - inset : inset; };
      smallest = std::min(smallest, trilinear_jacobian(cell, at(4), at(2), at(1)).determinant());
    }
  }
  return smallest;
}

void expect_positive_cells(std::initializer_list<int> budgets) {
  for (const Fruit& fruit :
       {apple, apple_of_narrow_hollows, apple_of_wide_hollows, flat_apple, pear, leaning_pear}) {
    const Surface surface = surface_of(fruit);
    for (const int budget : budgets) {
      const Result<LatticeMesh> made = tube_lattice(surface, {budget, {}});
      ASSERT_TRUE(made.ok()) << fruit.name << ", " << budget << ": " << made.error().message;
      const LatticeMesh& mesh = made.value();
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        for (int i = 0; i + 1 < mesh.count[0]; ++i) {
          for (int j = 0; j + 1 < mesh.count[1]; ++j) {
            EXPECT_GT(smallest_determinant(mesh.cell(i, j, k)), 0.0)
                << fruit.name << ", " << budget << ": " << i << " " << j << " " << k;
          }
        }
      }
      // The cells must be as good as those of a ball, whose caps are also made from flat squares.
      EXPECT_GT(measure_cell_quality(mesh).worst_jacobian, 0.05) << fruit.name << ", " << budget;
    }
  }
}

TEST(HollowEnds, HavePositiveCells) {
  if (sanitized) return expect_positive_cells({500});
  expect_positive_cells({500, 2000});
}

TEST(HollowEnds, HaveManyPositiveCells) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  expect_positive_cells({8000});
}

TEST(HollowEnds, AreAsHollowAsTheyAreSaidToBe) {
  for (const Fruit& fruit : {apple, apple_of_narrow_hollows, apple_of_wide_hollows}) {
    EXPECT_GE(depths_of(surface_of(fruit)).low, 0.25) << fruit.name;
    EXPECT_GE(depths_of(surface_of(fruit)).high, 0.25) << fruit.name;
  }
  for (const Fruit& fruit : {flat_apple, pear, leaning_pear}) {
    EXPECT_GE(depths_of(surface_of(fruit)).low, 0.1) << fruit.name;
    EXPECT_GE(depths_of(surface_of(fruit)).high, 0.05) << fruit.name;
  }
}

// Chords lose 1.2 % of the volume of a round body. Filling the hollows would add more than the tolerance.
TEST(HollowEnds, HoldTheirVolume) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const Fruit& fruit :
       {apple, apple_of_narrow_hollows, apple_of_wide_hollows, flat_apple, pear, leaning_pear}) {
    const Surface surface = surface_of(fruit);
    const LatticeMesh mesh = tube_lattice(surface, {2000, {}}).value();
    EXPECT_NEAR(volume_of(mesh) / enclosed_volume_m3(surface), 1.0, 0.03) << fruit.name;
  }
}

TEST(HollowEnds, HaveTheSameNodesEachTime) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const Fruit& fruit : {apple, leaning_pear}) {
    const Surface surface = surface_of(fruit);
    EXPECT_EQ(tube_lattice(surface, {2000, {}}).value().nodes,
              tube_lattice(surface, {2000, {}}).value().nodes)
        << fruit.name;
  }
}

// The hollows are so deep that each pole is beyond the other: the shape is no body.
TEST(HollowEnds, ThatPassThroughEachOtherAreRefused) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Fruit turned = apple;
  turned.low_press = turned.high_press = 1.4;
  const Result<LatticeMesh> mesh = tube_lattice(surface_of(turned), {2000, {}});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().code, ErrorCode::self_intersecting);
  EXPECT_NE(mesh.error().message.find("cell (0, 0, 0)"), std::string::npos) << mesh.error().message;
}

}  // namespace
}  // namespace spoonbill
