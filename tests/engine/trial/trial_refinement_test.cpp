// Tests that trials of gelatin come to the same rest with half the step and with twice the nodes, in cases
// that are at least 3 degrees from sliding or falling, and how fast they converge.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "engine/simulation/body_hold.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/trial/gelatin_trial.h"

namespace spoonbill {
namespace {

// On the plate, 10 degrees are 6.7 from the angle of friction, atan(0.3).
struct RefinedCase {
  const char* name;
  GelatinTrial trial;
  ForceRun run = ForceRun::whole_table;
};

// Cells must resolve a shape for its rest to depend on them little. Cells of 2 to 3 mm see nothing of a
// rounding of 0.5 mm, and the body is a block for all of them; how much of a rounding of 3 mm they see
// differs from one size of cell to the next.
constexpr double resolved_rounding_m = 0.0005;

const RefinedCase refined_cases[] = {
    {"TiltedPlate", {.rounding_m = resolved_rounding_m, .tilt_deg = 10.0}},
    {"TiltedBowl", {.bowl_m = 0.008, .rounding_m = resolved_rounding_m, .tilt_deg = 10.0}, ForceRun::full},
    {"FallOnPlate", {.rounding_m = resolved_rounding_m, .fall_m = 0.02}},
};

void PrintTo(const RefinedCase& refined, std::ostream* out) {
  *out << refined.name;
}

class TrialRefinement : public testing::TestWithParam<RefinedCase> {
 protected:
  void SetUp() override {
    if (const std::string reason = find_skip_reason(GetParam().run); !reason.empty()) {
      GTEST_SKIP() << reason;
    }
  }
};

void print_rest(const std::string& row, const GelatinRest& rest) {
  const auto print_vector = [&](const std::string& what, const Vector3& vector, double unit,
                                const std::string& name) {
    for (int axis = 0; axis < 3; ++axis) {
      print_result(row, what + " " + "xyz"[axis], vector[axis] / unit, name);
    }
  };
  print_result(row, "nodes of the block", rest.nodes);
  print_result(row, "settled", rest.settled ? 1.0 : 0.0);
  print_result(row, "settled after", rest.settled_s, "s");
  print_vector("centre of mass", rest.centre_m, 1e-3, "mm");
  print_result(row, "distance moved", 1e3 * rest.moved_m.norm(), "mm");
  print_vector("force", rest.force_n, rest.weight_n, "weights");
  print_result(row, "sag of the top", 1e3 * rest.sag_m, "mm");
}

// Expects that two rests agree: positions within `farthest_m`, forces and sag within 2 %.
void expect_same_rest(const std::string& row, const GelatinRest& rest, const GelatinRest& refined,
                      double farthest_m) {
  constexpr double tolerance = 0.02;
  const double centre_m = (refined.centre_m - rest.centre_m).norm();
  const double nodes_mean_m = (refined.nodes_mean_m - rest.nodes_mean_m).norm();
  const double force = (refined.force_n - rest.force_n).norm() / rest.force_n.norm();
  const double sag = std::abs(refined.sag_m / rest.sag_m - 1.0);
  print_result(row, "centre of mass differs by", 1e3 * centre_m, "mm");
  print_result(row, "mean of the nodes differs by", 1e3 * nodes_mean_m, "mm");
  print_result(row, "allowed", 1e3 * farthest_m, "mm");
  print_result(row, "force differs by", 100.0 * force, "%");
  print_result(row, "sag differs by", 100.0 * sag, "%");
  EXPECT_TRUE(rest.settled && refined.settled);
  EXPECT_EQ(rest.stopped + refined.stopped, "");
  EXPECT_LE(centre_m, farthest_m);
  EXPECT_LE(nodes_mean_m, farthest_m);
  EXPECT_LE(force, tolerance);
  EXPECT_LE(sag, tolerance);
}

// The bounds are those of the judged table: 2 % of the distance that the centre of mass moves in the turn or
// in the fall, and for twice the nodes a tenth of a cell if that is more.
TEST_P(TrialRefinement, KeepsTheRest) {
  constexpr double tolerance = 0.02;
  const GelatinTrial coarse = GetParam().trial;
  GelatinTrial half_step = coarse, fine = coarse;
  half_step.step_division = 2;
  fine.node_budget *= 2;
  const GelatinRest rest = run_gelatin(coarse);
  const GelatinRest with_half_step = run_gelatin(half_step), with_more_nodes = run_gelatin(fine);
  print_rest(describe(coarse), rest);
  print_rest(describe(half_step), with_half_step);
  print_rest(describe(fine), with_more_nodes);
  const double farthest_m = tolerance * rest.moved_m.norm();
  expect_same_rest("half the step, " + describe(coarse), rest, with_half_step, farthest_m);
  expect_same_rest("twice the nodes, " + describe(coarse), rest, with_more_nodes,
                   std::max(farthest_m, 0.1 * rest.cell_m));
}

INSTANTIATE_TEST_SUITE_P(Table, TrialRefinement, testing::ValuesIn(refined_cases),
                         [](const auto& info) { return std::string(info.param.name); });

// A block of 24 x 12 x 24 mm that is held at its base, in gravity that is oblique to it.
Scene held_block(double cell_m, int step_division, double damping_time_s) {
  constexpr double width_m = 0.024, height_m = 0.012;
  Material material = made_elastic(bundled_material("gelatin-20-1"));
  material.damping_time_s = damping_time_s;
  Body block = stock_body("gelatin", BoxSize{{width_m, height_m, width_m}, resolved_rounding_m},
                          {0.0, 0.5 * height_m, 0.0}, material, 500);
  const int across = static_cast<int>(std::lround(width_m / cell_m)),
            along = static_cast<int>(std::lround(height_m / cell_m));
  block.lattice.counts = {{across + 1, along + 1, across + 1}};
  block.lattice.cells = LatticeCells::box;
  Scene scene;
  scene.bodies = {block};
  scene.planes = {{Vector3(0.0, 1e-5, 0.0), Vector3::UnitY()}};  // fixes the lowest nodes
  scene.sculpting.real_time = true;
  scene.sculpting.step_division = step_division;
  scene.sculpting.gravity_m_per_s2 = {3.0, -9.0, 0.0};
  return scene;
}

Vector3 find_centre_m(const Simulation& simulation) {
  return find_mass_centre(simulation.lattice(0)).position_m;
}

// Returns the order of convergence that three results show, each with half the step or cell of the one
// before: the binary logarithm of the ratio of their differences.
double find_order(const std::string& row, const std::array<Vector3, 3>& centres_m) {
  const double first_m = (centres_m[1] - centres_m[0]).norm(),
               second_m = (centres_m[2] - centres_m[1]).norm();
  const double order = std::log2(first_m / second_m);
  print_result(row, "first difference", 1e6 * first_m, "um");
  print_result(row, "second difference", 1e6 * second_m, "um");
  print_result(row, "order of convergence", order);
  return order;
}

// The block swings for 50 ms. Each substep moves nodes by the velocity at its end, which is of first order.
// Rounding hides the differences of still shorter steps.
TEST(TrialConvergence, IsOfFirstOrderInTheStep) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  const double damped_s = bundled_material("gelatin-20-1").damping_time_s;
  for (const double damping_time_s : {0.0, damped_s}) {
    std::array<Vector3, 3> centres_m;
    for (std::size_t k = 0; k < centres_m.size(); ++k) {
      Simulation simulation = make_simulation(held_block(3e-3, 1 << k, damping_time_s));
      advance(simulation, 50, idle_tool());
      centres_m[k] = find_centre_m(simulation);
    }
    EXPECT_NEAR(find_order(damping_time_s > 0.0 ? "damped block, step" : "block, step", centres_m), 1.0, 0.1);
  }
}

// The sag of the held block, whose edges make its stresses singular: the order is 1 instead of the 2 of a
// smooth solution.
TEST(TrialConvergence, IsOfFirstOrderInTheCells) {
  if (const std::string reason = find_skip_reason(ForceRun::whole_table); !reason.empty()) {
    GTEST_SKIP() << reason;
  }
  std::array<Vector3, 3> centres_m;
  for (std::size_t k = 0; k < centres_m.size(); ++k) {
    Scene scene = held_block(4e-3 / (1 << k), 1, damping_time_range_s.high);
    scene.sculpting.is_critically_damped = true;
    Simulation simulation = make_simulation(scene);
    Vector3 before_m = Vector3::Zero();
    for (int tick = 0; tick < 2000; tick += 100) {
      advance(simulation, 100, idle_tool());
      centres_m[k] = find_centre_m(simulation);
      if ((centres_m[k] - before_m).norm() < 1e-8) break;
      before_m = centres_m[k];
    }
  }
  EXPECT_NEAR(find_order("held block, cells", centres_m), 1.0, 0.2);
}

}  // namespace
}  // namespace spoonbill
