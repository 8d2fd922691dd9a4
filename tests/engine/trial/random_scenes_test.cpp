// Drops random bodies of random materials into fixed dishes, on plates and on the ground, and shakes some of
// the dishes. Whatever happens, the result must be finite, whole and without bodies inside each other, and
// the bodies must not gain energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/simulation/body_hold.h"
#include "engine/trial/body_measures.h"
#include "engine/trial/trial.h"
#include "engine/trial/trial_report.h"
#include "tests/engine/effort.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

// Random numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}

  double between(double low, double high) { return low + (high - low) * engine_() / 4294967296.0; }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  template <class Values>
  const auto& choose(const Values& values) {
    return values[static_cast<std::size_t>(below(static_cast<int>(values.size())))];
  }
  Vector3 direction() {
    Vector3 vector;
    do {
      vector = {between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)};
    } while (!(vector.norm() > 0.1 && vector.norm() < 1.0));
    return vector.normalized();
  }

 private:
  std::mt19937 engine_;
};

struct RandomScene {
  Scene scene;
  std::optional<TurnBody> shake;  // of the dish, to and fro
};

StockShapeSize random_size(Dice& dice) {
  const auto mm = [&](double low, double high) { return 1e-3 * dice.between(low, high); };
  switch (dice.below(4)) {
    case 0:
      return SphereSize{mm(5.0, 12.0)};
    case 1: {
      const Vector3 sides(mm(10.0, 25.0), mm(10.0, 25.0), mm(10.0, 25.0));
      return BoxSize{sides, dice.between(0.05, 0.3) * sides.minCoeff()};
    }
    case 2: {
      CylinderSize size{mm(5.0, 10.0), mm(10.0, 22.0), 0.0};
      size.rounding_m = default_rounding_m(size);
      return size;
    }
    default: {
      ConeSize size{mm(6.0, 12.0), mm(10.0, 20.0), mm(2.0, 6.0), 0.0};
      size.rounding_m = default_rounding_m(size);
      return size;
    }
  }
}

Body make_dish(Dice& dice, const Material& material) {
  Body dish;
  if (dice.chance(0.5)) {
    BowlSize size{0.07, 0.055, dice.between(0.005, 0.02), dice.between(0.7e-3, 2e-3)};
    dish = stock_body("bowl", size, Vector3::Zero(), material, 300);
    dish.rim = bowl_shape(size)->rim;
  } else {
    PlateSize size{0.09, 0.07, dice.between(0.7e-3, 4e-3)};
    size.corner_m = default_corner_m(size);
    dish = stock_body("plate", size, Vector3::Zero(), material, 300);
  }
  dish.kind = BodyKind::fixed;
  return dish;
}

double highest_m(const Surface& surface) {
  return *std::max_element(surface.net.y.begin(), surface.net.y.end());
}

// Turns a body about its middle, then moves its lowest point to a height beside the y axis.
void drop_from(Dice& dice, double height_m, Body& body) {
  const BodyPlacement turn{Vector3::Zero(), dice.direction(), dice.between(0.0, 180.0)};
  move_body(turn.pose(), body);
  const double lowest_m = *std::min_element(body.surface.net.y.begin(), body.surface.net.y.end());
  const Vector3 move(dice.between(-8e-3, 8e-3), height_m - lowest_m, dice.between(-8e-3, 8e-3));
  move_body({move, Quaternion::Identity()}, body);
}

RandomScene make_random_scene(std::uint32_t seed) {
  static const std::vector<std::string> materials = bundled_material_names();
  Dice dice(seed);
  RandomScene random;
  Scene& scene = random.scene;
  const auto material = [&] {
    Material chosen = bundled_material(dice.choose(materials));
    if (dice.chance(0.5)) chosen.friction = dice.between(0.0, 0.6);
    return chosen;
  };
  const int count = 1 + dice.below(6);
  const bool has_dish = count > 1 && dice.chance(0.75);
  if (has_dish) scene.bodies.push_back(make_dish(dice, material()));
  if (!has_dish || dice.chance(0.5)) {
    scene.ground =
        Ground{Vector3(0.0, has_dish ? -0.04 : 0.0, 0.0), Vector3::UnitY(), dice.between(0.0, 0.6)};
  }
  double height_m = has_dish ? highest_m(scene.bodies[0].surface) : 0.0;
  while (scene.bodies.size() < static_cast<std::size_t>(count)) {
    Body body = stock_body("body " + std::to_string(scene.bodies.size()), random_size(dice), Vector3::Zero(),
                           material(), 150 + dice.below(250));
    if (dice.chance(0.3)) body.kind = BodyKind::rigid;
    if (dice.chance(0.5)) body.lattice.cells = LatticeCells::box;
    height_m += dice.between(0.5e-3, scene.bodies.size() == 1 ? 50e-3 : 10e-3);
    drop_from(dice, height_m, body);
    height_m = highest_m(body.surface);
    scene.bodies.push_back(std::move(body));
  }
  if (has_dish && dice.chance(0.6)) {
    const double arm_m = dice.between(0.02, 0.15), speed_m_per_s = dice.between(0.1, 1.0);
    const double angle = dice.between(0.0, 2.0 * std::numbers::pi);
    TurnBody shake;
    shake.point_m = {0.0, dice.chance(0.5) ? arm_m : -arm_m, 0.0};
    shake.axis = {std::cos(angle), 0.0, std::sin(angle)};
    shake.angle_deg = dice.between(5.0, 30.0);
    shake.speed_deg_per_s = std::min(360.0, speed_m_per_s / arm_m * 180.0 / std::numbers::pi);
    random.shake = shake;
  }
  return random;
}

// Compares the energy of the bodies with what they began with and with the work that the dish did on them.
class EnergyBalance {
 public:
  explicit EnergyBalance(const Simulation& simulation)
      : meters_(simulation.scene().bodies.size()), start_j_(find_energy_j(simulation)) {}

  // Call after each tick.
  void follow(const Simulation& simulation) {
    for (int b = 0; b < static_cast<int>(meters_.size()); ++b) {
      const double work_j = simulation.contact_work_j(b);
      work_j_ += work_j;
      given_j_ += std::max(work_j, 0.0);
    }
    if (simulation.tick() % 10 != 0) return;
    const double energy_j = find_energy_j(simulation);
    largest_gain_j_ = std::max(largest_gain_j_, energy_j - start_j_ - work_j_);
    // Gravity has given what the bodies have lost in height.
    given_by_gravity_j_ = std::max(given_by_gravity_j_, start_j_ - weight_energy_j_);
  }

  // Largest gain of energy so far, over what gravity and the dish gave the bodies.
  double largest_gain() const {
    const double given_j = given_by_gravity_j_ + given_j_;
    return given_j > 0.0 ? largest_gain_j_ / given_j : 0.0;
  }

 private:
  // Displacements are in single precision, whose rounding strains a body that has fallen farther than this.
  static constexpr double farthest_strained_m = 1.0;

  // Kinetic and gravitational energy, and elastic energy of bodies that are elastic and near. Elastic energy
  // is never negative, so bodies that gain energy without it gain energy with it.
  double find_energy_j(const Simulation& simulation) {
    const Vector3& gravity = simulation.scene().sculpting.gravity_m_per_s2;
    double energy_j = 0.0;
    weight_energy_j_ = 0.0;
    for (std::size_t b = 0; b < meters_.size(); ++b) {
      if (simulation.scene().bodies[b].kind == BodyKind::fixed) continue;
      if (const RigidDynamics* const rigid = simulation.rigid_dynamics(static_cast<int>(b))) {
        energy_j += rigid->energy_j(gravity);
        weight_energy_j_ -= rigid->mass().mass_kg * gravity.dot(rigid->centre_m());
        continue;
      }
      const SpringLattice& lattice = simulation.lattice(static_cast<int>(b));
      const MassCentre centre = find_mass_centre(lattice);
      const double weight_j = -centre.mass_kg * gravity.dot(centre.position_m);
      double kinetic_j = 0.0;
      for (int n = 0; n < lattice.mesh().node_count(); ++n) {
        const auto mass = static_cast<double>(lattice.mass(n));
        kinetic_j += 0.5 * mass * lattice.velocity(n).squaredNorm();
      }
      const bool is_far = centre.position_m.norm() > farthest_strained_m;
      const std::optional<double> whole_j =
          is_far ? std::nullopt : meters_[b].find_energy_j(lattice, gravity);
      energy_j += whole_j.value_or(kinetic_j + weight_j);
      weight_energy_j_ += weight_j;
    }
    return energy_j;
  }

  std::vector<EnergyMeter> meters_;
  double weight_energy_j_ = 0.0;  // gravitational part of the last find_energy_j()
  double start_j_ = 0.0;
  double work_j_ = 0.0, given_j_ = 0.0, given_by_gravity_j_ = 0.0, largest_gain_j_ = 0.0;
};

struct Outcome {
  std::string stopped;       // what stopped the trial; empty if nothing did
  double energy_gain = 0.0;  // EnergyBalance::largest_gain()
  double largest_overlap_cells = 0.0, last_overlap_cells = 0.0;
  int inverted_cells = 0;
  bool finite = true;
};

// Runs a scene for a second. The dish is shaken from 0.3 s to 0.7 s.
Outcome run_scene(const RandomScene& random) {
  constexpr int ticks = 1000, first_shaken = 300, last_shaken = 700;
  Outcome outcome;
  auto made = Simulation::make(make_trial_scene(random.scene, {}).value(), best_instruction_set());
  if (!made) {
    outcome.stopped = made.error().message;
    return outcome;
  }
  Simulation& simulation = made.value();
  double cell_m = 0.0;
  for (std::size_t b = 0; b < random.scene.bodies.size(); ++b) {
    if (random.scene.bodies[b].kind != BodyKind::deformable) continue;
    cell_m = std::max(cell_m, static_cast<double>(simulation.lattice(static_cast<int>(b)).cell_size_m()));
  }
  Trial trial(simulation.scene(), {600.0, 600.0});
  EnergyBalance balance(simulation);
  double direction = 1.0;
  for (int tick = 0; tick < ticks && outcome.stopped.empty(); ++tick) {
    if (random.shake && tick >= first_shaken && tick < last_shaken && !simulation.is_moving_bodies()) {
      TurnBody turn = *random.shake;
      turn.angle_deg *= direction;
      direction = -direction;
      EXPECT_TRUE(simulation.apply(turn).ok());
    }
    const Reaction reaction = simulation.advance(trial_input());
    if (const Status held = trial.follow(simulation, reaction.flags); !held) {
      outcome.stopped = held.error().message;
    }
    balance.follow(simulation);
    if (!(cell_m > 0.0)) continue;
    outcome.last_overlap_cells = simulation.largest_overlap_m() / cell_m;
    outcome.largest_overlap_cells = std::max(outcome.largest_overlap_cells, outcome.last_overlap_cells);
  }
  outcome.energy_gain = balance.largest_gain();
  const TrialReport report = report_on(trial, simulation);
  outcome.inverted_cells = report.inverted_cells;
  outcome.finite = std::isfinite(trial.largest_speed_m_per_s());
  for (const TrialBodyReport& body : report.bodies) {
    outcome.finite = outcome.finite && body.centre_of_mass_m.allFinite();
  }
  return outcome;
}

// While stiff bodies hit each other, and while a heavy body crushes a soft one, they overlap for some ticks.
constexpr double largest_overlap_cells = 0.4, last_overlap_limit_cells = 0.1;
constexpr double largest_energy_gain = 0.01;

void expect_whole(std::uint32_t seed) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  const Outcome outcome = run_scene(make_random_scene(seed));
  EXPECT_EQ(outcome.stopped, "");
  EXPECT_TRUE(outcome.finite);
  EXPECT_EQ(outcome.inverted_cells, 0);
  EXPECT_LT(outcome.energy_gain, largest_energy_gain);
  EXPECT_LT(outcome.largest_overlap_cells, largest_overlap_cells);
  EXPECT_LT(outcome.last_overlap_cells, last_overlap_limit_cells);
}

TEST(RandomScenes, StayWhole) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const std::uint32_t seed : {6u, 8u, 17u, 19u}) expect_whole(seed);
}

TEST(RandomScenes, StayWholeInTwelve) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const std::uint32_t seed : {0u, 1u, 2u, 4u, 5u, 7u, 10u, 12u, 14u, 18u, 21u, 22u}) expect_whole(seed);
}

// Free stiff bodies hit rigid ones at many points at once, for which the contacts first assume too much
// inertia.
TEST(RandomScenes, StayWholeWhenStiffBodiesCollide) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const std::uint32_t seed : {27u, 97u}) expect_whole(seed);
}

// Heavy bodies crush gelatin, whose nodes then move by more than half a cell in the damping time.
TEST(RandomScenes, StayWholeWhenGelatinIsCrushed) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const std::uint32_t seed : {23u, 58u}) expect_whole(seed);
}

// A point of gelatin meets a fast body. Light nodes beside the point are moved by several times the speed
// that the point loses.
TEST(RandomScenes, StayWholeWhenLightNodesAreHit) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  for (const std::uint32_t seed : {36u, 56u}) expect_whole(seed);
}

// A body is crushed until corners of its cells are inside out. Springs alone keep them so.
TEST(RandomScenes, StayWholeWhenCellsAreTurnedInsideOut) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  if (!is_full_run()) GTEST_SKIP() << only_in_full;
  expect_whole(145u);
}

}  // namespace
}  // namespace spoonbill
