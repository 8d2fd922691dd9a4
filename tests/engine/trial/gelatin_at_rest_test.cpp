// Tests that gelatin laid on a plate and in bowls comes to rest, keeps its cells, stays out of what bears it,
// and gains no energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "engine/trial/body_measures.h"
#include "tests/engine/forces/samples.h"
#include "tests/engine/trial/gelatin_trial.h"

namespace spoonbill {
namespace {

struct RestCase {
  GelatinTrial trial;
  ForceRun run = ForceRun::whole_table;
};

void PrintTo(const RestCase& rest_case, std::ostream* out) {
  *out << describe(rest_case.trial);
}

class GelatinAtRest : public testing::TestWithParam<RestCase> {};

TEST_P(GelatinAtRest, SettlesOutsideWhatBearsIt) {
  const RestCase& rest_case = GetParam();
  if (const std::string reason = find_skip_reason(rest_case.run); !reason.empty()) GTEST_SKIP() << reason;
  const GelatinRest rest = run_gelatin(rest_case.trial);
  const std::string row = describe(rest_case.trial);
  // The bound of the judged table: 0.05 mm, or 2 % of a cell if that is more.
  const double depth_limit_m = std::max(5e-5, 0.02 * rest.cell_m);
  print_result(row, "nodes of the block", rest.nodes);
  print_result(row, "settled after", rest.settled_s, "s");
  print_result(row, "speed at the end", 1e3 * rest.speed_m_per_s, "mm/s");
  print_result(row, "smallest Jacobian", rest.smallest_jacobian);
  print_result(row, "skin inside by", 1e3 * rest.depth_m, "mm");
  print_result(row, "allowed", 1e3 * depth_limit_m, "mm");
  print_result(row, "sag of the top", 1e3 * rest.sag_m, "mm");
  print_result(row, "push over weight", -rest.force_n.y() / rest.weight_n);
  EXPECT_EQ(rest.stopped, "");
  EXPECT_TRUE(rest.settled);
  EXPECT_EQ(rest.inverted_cells, 0);
  EXPECT_LE(rest.depth_m, depth_limit_m);
}

std::string name_of_case(const testing::TestParamInfo<RestCase>& info) {
  const GelatinTrial& trial = info.param.trial;
  const auto rounded = [](double value) { return std::to_string(std::lround(value)); };
  return (trial.bowl_m ? "Bowl" + rounded(1e3 * *trial.bowl_m) : "Plate") + "Friction" +
         rounded(100.0 * trial.friction) + "Nodes" + std::to_string(trial.node_budget);
}

std::vector<RestCase> all_cases() {
  std::vector<RestCase> all;
  for (const std::optional<double> bowl_m :
       {std::optional<double>(), std::optional(0.005), std::optional(0.008), std::optional(0.012)}) {
    for (const double friction : {0.3, 0.02}) {
      for (const int node_budget : {500, 1000, 2000, 4000}) {
        RestCase one{{.bowl_m = bowl_m, .friction = friction, .node_budget = node_budget}};
        if (node_budget == 500 && friction == 0.3) {
          if (!bowl_m) one.run = ForceRun::always;
          if (bowl_m == 0.008) one.run = ForceRun::full;
        }
        all.push_back(one);
      }
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Table, GelatinAtRest, testing::ValuesIn(all_cases()), name_of_case);

// Follows gelatin that nothing damps and no friction stops, from 0.1 mm above what bears it.
class UndampedGelatin : public testing::TestWithParam<RestCase> {};

TEST_P(UndampedGelatin, NeverHasMoreEnergyThanAtItsStart) {
  const RestCase& rest_case = GetParam();
  if (const std::string reason = find_skip_reason(rest_case.run); !reason.empty()) GTEST_SKIP() << reason;
  constexpr double seconds = 3.0;
  Simulation simulation = make_simulation(gelatin_scene(rest_case.trial));
  const Vector3& gravity = simulation.scene().sculpting.gravity_m_per_s2;
  const SpringLattice& lattice = simulation.lattice(0);
  const Material& material = simulation.scene().bodies[0].material;
  // Static drop of the centre of mass of a column under its own weight, rho g H^2 / 3 E: the mean over the
  // height of rho g (H y - y^2 / 2) / E. The block in a bowl sags more, so that the bound is strict there.
  const double sag_m = material.density_kg_per_m3 * gravity.norm() * gelatin_height_m * gelatin_height_m /
                       (3.0 * material.youngs_modulus_pa);
  const double scale_j = lattice.mass_kg() * gravity.norm() * sag_m;
  EnergyMeter meter;
  const double start_j = meter.find_energy_j(lattice, gravity).value();
  double largest_j = -1e9, lowest_j = start_j, largest_rise_j = 0.0, end_j = start_j;
  for (int tick = 0; tick < static_cast<int>(seconds / tick_s); ++tick) {
    const Reaction reaction = simulation.advance(trial_input());
    ASSERT_EQ(reaction.flags & (tick_flag_body_limited | tick_flag_nodes_slowed | tick_flag_speed_capped),
              0u);
    end_j = meter.find_energy_j(lattice, gravity).value();
    largest_j = std::max(largest_j, end_j);
    lowest_j = std::min(lowest_j, end_j);
    largest_rise_j = std::max(largest_rise_j, end_j - lowest_j);
  }
  const std::string row = describe(rest_case.trial);
  print_result(row, "weight times sag", 1e6 * scale_j, "uJ");
  print_result(row, "largest energy above the start", 100.0 * (largest_j - start_j) / scale_j,
               "% of weight x sag");
  print_result(row, "energy at the end above the start", 100.0 * (end_j - start_j) / scale_j,
               "% of weight x sag");
  print_result(row, "largest climb above a minimum", 100.0 * largest_rise_j / scale_j, "% of weight x sag");
  EXPECT_LE(largest_j - start_j, 0.01 * scale_j);
}

std::vector<RestCase> undamped_cases() {
  std::vector<RestCase> all;
  for (const std::optional<double> bowl_m : {std::optional<double>(), std::optional(0.008)}) {
    for (const int node_budget : {500, 1000}) {
      all.push_back(
          {{.bowl_m = bowl_m, .friction = 0.0, .node_budget = node_budget, .fall_m = 1e-4, .damped = false}});
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Table, UndampedGelatin, testing::ValuesIn(undamped_cases()), name_of_case);

}  // namespace
}  // namespace spoonbill
