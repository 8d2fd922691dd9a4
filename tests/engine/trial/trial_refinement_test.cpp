// Tests that trials of gelatin come to the same rest with half the step and with twice the nodes, in cases
// that are at least 3 degrees from sliding or falling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

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

}  // namespace
}  // namespace spoonbill
