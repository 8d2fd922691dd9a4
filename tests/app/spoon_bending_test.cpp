// Tests how spoons bend, against Timoshenko's theory of beams and CalculiX.
#include "app/study/spoon_bending.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "engine/exchange/document.h"
#include "engine/trial/trial.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr double length_m = 0.1, held_m = 0.01, width_m = 0.012, height_m = 0.003, rounding_m = 0.0003;

// Second moment of area of the bar, whose four long edges have twice the rounding of its ends.
double second_moment_m4() {
  constexpr int steps = 20000;
  const double radius = 2.0 * rounding_m;
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double y = height_m * ((k + 0.5) / steps - 0.5);
    const double beyond = std::abs(y) - (0.5 * height_m - radius);
    const double width =
        beyond > 0.0 ? width_m - 2.0 * (radius - std::sqrt(radius * radius - beyond * beyond)) : width_m;
    sum += width * y * y * height_m / steps;
  }
  return sum;
}

double area_m2() {
  const double radius = 2.0 * rounding_m;
  return width_m * height_m - (4.0 - 3.14159265358979) * radius * radius;
}

HeldLever make_bar(const Material& material) {
  HeldLever bar;
  bar.body = stock_body("bar", BoxSize{{length_m + held_m, height_m, width_m}, rounding_m}, Vector3::Zero(),
                        material, bending_node_budget);
  bar.hand = {{-0.5 * (length_m + held_m) + held_m, 0.0, 0.0}, Vector3::UnitX()};
  const double v_start = bar.body.surface.v.domain_start(), v_end = bar.body.surface.v.domain_end();
  const bool ends_at_front = position(bar.body.surface, 0.0, v_end).x() > 0.0;
  bar.loaded = bar.measured = {0.0, ends_at_front ? v_end : v_start};
  return bar;
}

// A straight handle of 12 x 3 mm, free over 100 mm, and 0.2 N at its end.
TEST(SpoonBending, IsThatOfTimoshenkosBeam) {
  for (const char* const name : {"abs", "steel-304"}) {
    const Material material = made_elastic(bundled_material(name));
    const HeldLever bar = make_bar(material);
    const auto own = bend_lever(bar, 0.0);
    ASSERT_TRUE(own.ok());
    const double free_m = length_m + own->behind_plane_m;
    const double load_n = 0.2, i = second_moment_m4(), e = material.youngs_modulus_pa;
    const double shear = 1.0 + 0.75 * std::pow(height_m / free_m, 2.0);
    const double line_n_per_m = material.density_kg_per_m3 * standard_gravity_m_per_s2 * area_m2();
    const double by_load_m = shear * load_n * std::pow(free_m, 3.0) / (3.0 * e * i),
                 by_weight_m = line_n_per_m * std::pow(free_m, 4.0) / (8.0 * e * i);
    EXPECT_NEAR(own->drop_m, by_weight_m, 0.025 * by_weight_m) << name;
    const auto loaded = bend_lever(bar, load_n / standard_gravity_m_per_s2);
    ASSERT_TRUE(loaded.ok());
    EXPECT_NEAR(loaded->drop_m, by_weight_m + by_load_m, 0.025 * (by_weight_m + by_load_m)) << name;
    // The strain of the outer fibre at the hand, averaged over the length of a cell, is a little less.
    const double moment_nm = load_n * free_m + 0.5 * line_n_per_m * free_m * free_m;
    const double strain = 0.5 * height_m * moment_nm / (e * i);
    EXPECT_NEAR(loaded->largest_strain, strain, 0.15 * strain) << name;
  }
}

// The bent spoon of polypropylene beside CalculiX, whose finer mesh is taken.
TEST(SpoonBending, IsThatOfCalculix) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  std::ifstream in(SPOONBILL_BENT_SPOON);
  std::string line;
  std::getline(in, line);
  double finest_mm = 10.0, hand_mm = 0.0;
  std::map<double, double> drop_mm;  // by the food in kg
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    double size_mm = 0.0, nodes = 0.0, food_kg = 0.0, drop = 0.0;
    ASSERT_TRUE(std::istringstream(line) >> size_mm >> nodes >> hand_mm >> food_kg >> drop);
    if (size_mm > finest_mm) continue;
    finest_mm = size_mm;
    drop_mm[food_kg] = drop;
  }
  ASSERT_EQ(drop_mm.size(), 2u);
  StudySpoon spoon;
  spoon.body = bundled_scene("spoon-bent").bodies.front();
  spoon.bowl = find_bowl(spoon.body, Vector3::UnitY()).value();
  const auto bending = bend_spoon(spoon, bundled_material("polypropylene"), drop_mm.rbegin()->first);
  ASSERT_TRUE(bending.ok());
  EXPECT_NEAR(1e3 * bending->hand_m, hand_mm, 0.01);
  const double own_mm = drop_mm.begin()->second, loaded_mm = drop_mm.rbegin()->second;
  EXPECT_NEAR(1e3 * bending->own_weight.drop_m, own_mm, 0.025 * own_mm);
  EXPECT_NEAR(1e3 * bending->with_food.drop_m, loaded_mm, 0.025 * loaded_mm);
}

TEST(SpoonBending, NeedsAHandle) {
  StudySpoon spoon;
  spoon.body = bundled_scene("spoon-bowl").bodies.front();
  spoon.bowl = find_bowl(spoon.body, Vector3::UnitY()).value();
  EXPECT_EQ(bend_spoon(spoon, bundled_material("abs"), 0.006).error().code, ErrorCode::unsupported);
}

// Twice the food bends an elastic spoon by twice as much, and the handle of the thick spoon hardly bends.
TEST(SpoonBending, GrowsWithTheFood) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  StudySpoon spoon;
  spoon.body = bundled_scene("spoon-original").bodies.front();
  spoon.bowl = find_bowl(spoon.body, Vector3::UnitY()).value();
  const Material material = bundled_material("polypropylene");
  const auto once = bend_spoon(spoon, material, 0.006), twice = bend_spoon(spoon, material, 0.012);
  ASSERT_TRUE(once.ok() && twice.ok());
  EXPECT_GT(once->own_weight.drop_m, 1e-5);
  const double own_m = once->own_weight.drop_m;
  EXPECT_NEAR((twice->with_food.drop_m - own_m) / (once->with_food.drop_m - own_m), 2.0, 0.02);
}

}  // namespace
}  // namespace spoonbill
