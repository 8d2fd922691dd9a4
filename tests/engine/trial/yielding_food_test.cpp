// Tests that food which yields keeps its cells and its volume until it has left the bowl, whatever its
// stiffness, its yield stress and the tilt, and that it spills at the same time with shorter steps and finer
// cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "engine/trial/trial.h"
#include "engine/trial/trial_report.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr double height_m = 0.015, density_kg_per_m3 = 1030.0;

struct Food {
  double youngs_modulus_pa = 0.0;
  double yield_stress = 0.0;     // over the pressure of the food's own height
  std::optional<double> bowl_m;  // depth of the bowl; empty: the food lies on the ground
  double tilt_deg = 0.0;
  ForceRun run = ForceRun::whole_table;
};

std::string describe(const Food& food) {
  const auto rounded = [](double value) { return std::to_string(std::lround(value)); };
  std::string text = rounded(1e-3 * food.youngs_modulus_pa) + " kPa, yields at " +
                     rounded(100.0 * food.yield_stress) + " % of its own pressure, ";
  if (!food.bowl_m) return text + "on the ground";
  return text + "bowl of " + rounded(1e3 * *food.bowl_m) + " mm, " + rounded(food.tilt_deg) + " degrees";
}

void PrintTo(const Food& food, std::ostream* out) {
  *out << describe(food);
}

Body yielding_jelly(const Food& food, int node_budget) {
  Material material = made_elastic(bundled_material("gelatin-20-1"));
  material.youngs_modulus_pa = food.youngs_modulus_pa;
  material.poissons_ratio = 0.49;
  material.density_kg_per_m3 = density_kg_per_m3;
  material.friction = bundled_material("gelatin-20-1").friction;
  material.plastic = true;
  material.flow_rate_per_s = 300.0;
  material.yield_strain =
      food.yield_stress * density_kg_per_m3 * standard_gravity_m_per_s2 * height_m / food.youngs_modulus_pa;
  return stock_body("jelly", BoxSize{{0.03, height_m, 0.024}, 0.003}, {0.0, 0.5 * height_m + 1e-4, 0.0},
                    material, node_budget);
}

Scene food_scene(const Food& food, int node_budget) {
  Scene scene;
  scene.bodies = {yielding_jelly(food, node_budget)};
  if (!food.bowl_m) {
    scene.ground = Ground{Vector3::Zero(), Vector3::UnitY(), 0.3};
    return make_trial_scene(scene, {}).value();
  }
  const BowlSize size{0.06, 0.042, *food.bowl_m, 1e-3};
  Body bowl =
      stock_body("bowl", size, {0.0, -0.5 * *food.bowl_m - 1e-3, 0.0}, bundled_material("steel-304"), 300);
  bowl.kind = BodyKind::fixed;
  bowl.rim = bowl_shape(size)->rim;
  scene.bodies.push_back(bowl);
  scene.trial = TrialPlan{"jelly", 0.01, "bowl", Vector3::Zero(), Vector3::UnitZ(), food.tilt_deg, 30.0};
  return make_trial_scene(scene, food.tilt_deg).value();
}

struct Course {
  std::string stopped;  // what stopped the trial; empty if nothing did
  double smallest_jacobian = 1.0, largest_volume_change = 0.0;  // until the food has left the bowl
  std::optional<double> first_spill_s, left_s;                  // since the turn began
  bool settled = false;
};

// Runs a trial until the food has settled after the turn, or has left the bowl, or for ten seconds.
Course run_trial(Scene scene, int step_division = 1) {
  scene.sculpting.step_division = step_division;
  Simulation simulation = make_simulation(scene);
  Trial trial(simulation.scene(), {10.0, 10.0});
  Course course;
  double turn_s = 0.0;
  for (int tick = 0; trial.phase() != TrialPhase::done; ++tick) {
    if (trial.phase() < TrialPhase::turning) turn_s = trial.time_s();
    while (const auto command = trial.next_command()) EXPECT_TRUE(simulation.apply(*command).ok());
    const Reaction reaction = simulation.advance(trial_input());
    if (const Status held = trial.follow(simulation, reaction.flags); !held) {
      course.stopped = held.error().message;
      return course;
    }
    if (tick % 20 != 0) continue;
    const TrialBodyReport report = report_on(trial, simulation).bodies[0];
    course.smallest_jacobian = std::min(course.smallest_jacobian, report.smallest_jacobian);
    course.largest_volume_change =
        std::max(course.largest_volume_change, std::abs(report.volume_ratio - 1.0));
    if (report.spill) {
      if (report.spill->first_spill_s) course.first_spill_s = *report.spill->first_spill_s - turn_s;
      if (report.spill->left_s) course.left_s = *report.spill->left_s - turn_s;
    }
    course.settled = trial.phase() == TrialPhase::watching && trial.is_settled();
    if (course.settled || course.left_s) break;
  }
  return course;
}

class YieldingFood : public testing::TestWithParam<Food> {};

TEST_P(YieldingFood, KeepsItsCellsAndItsVolume) {
  const Food& food = GetParam();
  if (const std::string reason = find_skip_reason(food.run); !reason.empty()) GTEST_SKIP() << reason;
  const Course course = run_trial(food_scene(food, 500));
  const std::string row = describe(food);
  print_result(row, "smallest Jacobian", course.smallest_jacobian);
  print_result(row, "largest change of volume", 100.0 * course.largest_volume_change, "%");
  if (course.first_spill_s) print_result(row, "spills at", *course.first_spill_s, "s");
  if (course.left_s) print_result(row, "leaves at", *course.left_s, "s");
  if (course.settled) print_result(row, "settled", 1.0);
  EXPECT_EQ(course.stopped, "");
  EXPECT_GT(course.smallest_jacobian, 0.1);
  EXPECT_LT(course.largest_volume_change, 0.01);
}

std::string name_of_food(const testing::TestParamInfo<Food>& info) {
  const Food& food = info.param;
  const auto rounded = [](double value) { return std::to_string(std::lround(value)); };
  const std::string where = food.bowl_m ? "Bowl" + rounded(1e3 * *food.bowl_m) : "Ground";
  return "E" + rounded(food.youngs_modulus_pa) + "Yield" + rounded(100.0 * food.yield_stress) + where +
         "Tilt" + rounded(food.tilt_deg);
}

std::vector<Food> all_food() {
  std::vector<Food> all;
  for (const double youngs_modulus_pa : {1000.0, 5000.0}) {
    for (const double yield_stress : {0.31, 1.0, 3.0}) {
      all.push_back({youngs_modulus_pa, yield_stress, {}, 0.0});
      for (const double bowl_m : {0.005, 0.008, 0.012}) {
        for (const double tilt_deg : {0.0, 15.0, 30.0}) {
          all.push_back({youngs_modulus_pa, yield_stress, bowl_m, tilt_deg});
        }
      }
    }
  }
  // One case of the table in tests/run --full.
  for (Food& food : all) {
    if (food.youngs_modulus_pa == 5000.0 && food.yield_stress == 1.0 && food.bowl_m == 0.008 &&
        food.tilt_deg == 15.0) {
      food.run = ForceRun::full;
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Table, YieldingFood, testing::ValuesIn(all_food()), name_of_food);

// The time of the first spill is the same within a tenth with half the step and with twice the nodes.
TEST(YieldingFoodInAFlatBowl, SpillsAtTheSameTime) {
  if (const std::string reason = find_skip_reason(ForceRun::whole_table); !reason.empty()) {
    GTEST_SKIP() << reason;
  }
  const Food food{1000.0, 0.5, 0.005, 30.0};
  const Course course = run_trial(food_scene(food, 500));
  const Course half_step = run_trial(food_scene(food, 500), 2);
  const Course fine = run_trial(food_scene(food, 1000));
  for (const Course& each : {course, half_step, fine}) EXPECT_EQ(each.stopped, "");
  ASSERT_TRUE(course.first_spill_s && half_step.first_spill_s && fine.first_spill_s);
  print_result(describe(food), "spills at", *course.first_spill_s, "s");
  print_result(describe(food), "with half the step", *half_step.first_spill_s, "s");
  print_result(describe(food), "with twice the nodes", *fine.first_spill_s, "s");
  EXPECT_NEAR(*half_step.first_spill_s, *course.first_spill_s, 0.1 * *course.first_spill_s);
  EXPECT_NEAR(*fine.first_spill_s, *course.first_spill_s, 0.1 * *course.first_spill_s);
}

}  // namespace
}  // namespace spoonbill
