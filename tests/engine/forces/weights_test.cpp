// Tests that supports, the ground and other bodies bear the weight of a body's exact volume, at any drag and
// with any inertia scale, and that bodies fall at g.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "engine/inspection/mass_properties.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr double g = 9.81;
const Vector3 gravity(0.0, -g, 0.0);

double weight_n(const Body& body) {
  return g * compute_body_mass(body).value().mass_kg();
}

// Advances by windows of 200 ticks and returns the mean of a force over the last window. Stops when this mean
// differs from the mean of the previous window by less than the fraction 2e-4, but not before six windows
// have passed, and at the latest after `most_ticks` ticks.
double settled_force_n(Simulation& simulation, int most_ticks, const std::function<double()>& force_n) {
  constexpr int window = 200;
  double before = 0.0, now = mean_over(simulation, window, idle_tool(), force_n);
  for (int ticks = window; ticks < most_ticks; ticks += window) {
    before = now;
    now = mean_over(simulation, window, idle_tool(), force_n);
    if (ticks >= 5 * window && std::abs(now - before) < 2e-4 * std::abs(now)) break;
  }
  return now;
}

void expect_weight(const std::string& what, double measured_n, double expected_n) {
  print_result("weights", what + ": force over weight", measured_n / expected_n);
  EXPECT_NEAR(measured_n / expected_n, 1.0, 5e-3) << what;
}

// Returns a copy of the body without loads and with an elastic material. Supports at both ends and halfway
// prevent it from sagging noticeably.
Body supported(Body body) {
  body.supports.clear();
  for (const Range<double> along : {Range<double>{0.0, 0.15}, {0.45, 0.55}, {0.85, 1.0}}) {
    body.supports.push_back({BodyRegion{along}});
  }
  body.loads.clear();
  body.material = made_elastic(body.material);
  return body;
}

// Returns the force with which the supports bear a body against gravity.
double support_n(const Simulation& simulation, int body = 0) {
  double sum = 0.0;
  const std::size_t supports = simulation.scene().bodies[static_cast<std::size_t>(body)].supports.size();
  for (std::size_t s = 0; s < supports; ++s) sum += simulation.support_force_n(static_cast<int>(s), body).y();
  return sum;
}

struct ModelCase {
  std::string model;
  ForceRun run;
};

void PrintTo(const ModelCase& model, std::ostream* out) {
  *out << model.model;
}

std::vector<ModelCase> model_cases() {
  std::vector<ModelCase> cases;
  for (const std::string& model : bundled_model_names()) {
    // The lattice of a trimmed body also covers what is trimmed away. The bodies of trials have no supports.
    if (model == "trimmed-plate" || bundled_scene(model).trial) continue;
    const ForceRun run = model == "spoon-handle" ? ForceRun::always
                         : model == "jelly"      ? ForceRun::full
                                                 : ForceRun::whole_table;
    cases.push_back({model, run});
  }
  return cases;
}

// Each model is simulated with the inertia scale that its lattice, material and substeps require.
class WeightOfModel : public testing::TestWithParam<ModelCase> {};

TEST_P(WeightOfModel, ReachesItsSupport) {
  if (const std::string reason = find_skip_reason(GetParam().run); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene = bundled_scene(GetParam().model);
  scene.planes.clear();
  scene.tool = {};
  scene.tool.substeps = bundled_scene(GetParam().model).tool.substeps;
  scene.sculpting.gravity_m_per_s2 = gravity;
  scene.sculpting.is_critically_damped = true;
  scene.ground.reset();
  for (Body& body : scene.bodies) body = supported(body);
  Simulation simulation = make_simulation(scene);
  const double force_n = settled_force_n(simulation, 10000, [&] { return support_n(simulation); });
  expect_weight(GetParam().model + ", r = " + std::to_string(simulation.inertia_scale()), force_n,
                weight_n(scene.bodies[0]));
}

INSTANTIATE_TEST_SUITE_P(, WeightOfModel, testing::ValuesIn(model_cases()));

Body small_block(const std::string& material, const Vector3& centre_m) {
  BoxSize size;
  size.size_m = {0.03, 0.02, 0.02};
  size.rounding_m = 0.001;
  Material elastic = made_elastic(bundled_material(material));
  elastic.friction = 0.5;
  return stock_body(material, size, centre_m, elastic, 250);
}

// With a large drag, a soft body would take minutes to come to rest. The drag is therefore set only after the
// body has come to rest.
TEST(WeightOnSupport, IsTheSameWithAnyDrag) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  for (const char* material : {"gelatin-20-1", "silicone-00-30", "abs", "steel-304"}) {
    Scene scene = settling_scene({supported(small_block(material, Vector3::Zero()))});
    scene.sculpting.gravity_m_per_s2 = gravity;
    Simulation simulation = make_simulation(scene);
    settled_force_n(simulation, 6000, [&] { return support_n(simulation); });
    for (const double drag : {0.0, 4.0, 30.0, 1000.0, 8000.0}) {
      Sculpting sculpting = scene.sculpting;
      sculpting.is_critically_damped = false;
      sculpting.drag_per_s = drag;
      ASSERT_TRUE(simulation.apply(SetSculpting{sculpting}).ok());
      const double force_n = mean_over(simulation, 500, idle_tool(), [&] { return support_n(simulation); });
      expect_weight(std::string(material) + " on supports, drag " + std::to_string(drag), force_n,
                    weight_n(scene.bodies[0]));
    }
  }
}

// Without drag, the force on the support of a released body oscillates about the weight.
TEST(WeightOnSupport, IsTheMeanWithoutDrag) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene;
  scene.bodies = {supported(small_block("silicone-00-30", Vector3::Zero()))};
  scene.sculpting.gravity_m_per_s2 = gravity;
  scene.sculpting.drag_per_s = 0.0;
  Simulation simulation = make_simulation(scene);
  const double force_n = mean_over(simulation, 6000, idle_tool(), [&] { return support_n(simulation); });
  expect_weight("silicone-00-30 on supports, no drag", force_n, weight_n(scene.bodies[0]));
}

TEST(WeightOnGround, IsTheBodys) {
  if (const std::string reason = find_skip_reason(ForceRun::full); !reason.empty()) GTEST_SKIP() << reason;
  for (const char* material : {"gelatin-20-1", "silicone-00-30", "abs", "steel-304"}) {
    for (const double drag : {30.0, 1000.0}) {
      Scene scene;
      scene.bodies = {small_block(material, {0.0, 0.01001, 0.0})};
      scene.sculpting.gravity_m_per_s2 = gravity;
      scene.sculpting.drag_per_s = drag;
      scene.ground = Ground{};
      Simulation simulation = make_simulation(scene);
      const double force_n =
          settled_force_n(simulation, 10000, [&] { return simulation.ground_force_n(0).y(); });
      expect_weight(std::string(material) + " on the ground, drag " + std::to_string(drag), force_n,
                    weight_n(scene.bodies[0]));
    }
  }
}

struct Stack {
  const char *lower, *upper;
  ForceRun run;
};

void PrintTo(const Stack& stack, std::ostream* out) {
  *out << stack.upper << " on " << stack.lower;
}

class WeightOnBody : public testing::TestWithParam<Stack> {};

// Returns the scene of a block on a plate.
Scene stack_scene(const Stack& stack) {
  BoxSize plate;
  plate.size_m = {0.06, 0.016, 0.03};
  plate.rounding_m = 0.001;
  Scene scene;
  scene.bodies = {
      stock_body("plate", plate, {0.0, -0.008, 0.0}, made_elastic(bundled_material(stack.lower)), 250),
      small_block(stack.upper, {0.0, 0.01001, 0.0})};
  scene.bodies[0].material.friction = 0.5;
  // The plate is supported at both ends, so that it hardly bends and nothing slides off. The block touches no
  // supported node, whose contacts would bypass the lattice.
  const Surface& surface = scene.bodies[0].surface;
  scene.bodies[0].supports = {{end_region(surface, 0, false, 0.1)}, {end_region(surface, 0, true, 0.1)}};
  scene.sculpting.gravity_m_per_s2 = gravity;
  scene.sculpting.drag_per_s = 30.0;
  return scene;
}

TEST_P(WeightOnBody, ReachesTheSupportOfTheOther) {
  const Stack& stack = GetParam();
  if (const std::string reason = find_skip_reason(stack.run); !reason.empty()) GTEST_SKIP() << reason;
  const Scene scene = stack_scene(stack);
  Simulation simulation = make_simulation(scene);
  const double force_n = settled_force_n(simulation, 8000, [&] { return support_n(simulation); });
  const double upper_n = weight_n(scene.bodies[1]);
  expect_weight(std::string(stack.upper) + " on " + stack.lower, force_n - weight_n(scene.bodies[0]),
                upper_n);
}

// Contacts that started from zero force in each tick would shake the block.
TEST(BlockOnPlate, ComesToRest) {
  if (const std::string reason = find_skip_reason(ForceRun::always); !reason.empty()) GTEST_SKIP() << reason;
  Simulation simulation = make_simulation(stack_scene({"silicone-soft", "abs", ForceRun::always}));
  advance(simulation, 600, idle_tool());
  const SpringLattice& block = simulation.lattice(1);
  for (int n = 0; n < block.mesh().node_count(); ++n) EXPECT_LT(block.velocity(n).norm(), 1e-3) << n;
}

// Contacts that close gaps other than those of the lattices' points would shake the gelatin for ever. The
// block is flat, so that its own damping stops its slowest motion within a second.
TEST(BlockOnPlate, ComesToRestWithoutDrag) {
  if (const std::string reason = find_skip_reason(ForceRun::always); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene = stack_scene({"steel-304", "gelatin-20-1", ForceRun::always});
  BoxSize flat;
  flat.size_m = {0.02, 0.01, 0.02};
  flat.rounding_m = 0.001;
  scene.bodies[1] =
      stock_body("block", flat, {0.0, 0.00501, 0.0}, made_elastic(bundled_material("gelatin-20-1")), 250);
  scene.bodies[0].supports.clear();
  scene.planes = {{Vector3::Zero(), Vector3::UnitY()}};
  scene.sculpting.drag_per_s = 0.0;
  Simulation simulation = make_simulation(scene);
  advance(simulation, 1500, idle_tool());
  const SpringLattice& block = simulation.lattice(1);
  for (int n = 0; n < block.mesh().node_count(); ++n) EXPECT_LT(block.velocity(n).norm(), 1e-4) << n;
}

INSTANTIATE_TEST_SUITE_P(, WeightOnBody,
                         testing::Values(Stack{"abs", "gelatin-20-1", ForceRun::full},
                                         Stack{"silicone-00-30", "gelatin-20-1", ForceRun::whole_table},
                                         Stack{"silicone-soft", "abs", ForceRun::whole_table},
                                         Stack{"steel-304", "silicone-00-30", ForceRun::whole_table}));

class FreeFall : public testing::TestWithParam<std::string> {};

Vector3 mean_position(const SpringLattice& lattice) {
  Vector3 sum = Vector3::Zero();
  double mass_kg = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto node_kg = static_cast<double>(lattice.mass(n));
    sum += node_kg * lattice.position(n);
    mass_kg += node_kg;
  }
  return sum / mass_kg;
}

TEST_P(FreeFall, IsThatOfAllBodies) {
  const ForceRun run = GetParam() == "gelatin-20-1" ? ForceRun::always
                       : GetParam() == "steel-304"  ? ForceRun::full
                                                    : ForceRun::whole_table;
  if (const std::string reason = find_skip_reason(run); !reason.empty()) GTEST_SKIP() << reason;
  Body body = small_block("abs", Vector3::Zero());
  body.material = bundled_material(GetParam());
  Scene scene;
  scene.bodies = {body};
  scene.sculpting.gravity_m_per_s2 = gravity;
  scene.sculpting.drag_per_s = 0.0;
  scene.sculpting.real_time = true;
  Simulation simulation = make_simulation(scene);
  // The second difference of the height is the mean acceleration of an interval.
  constexpr int ticks = 40;
  const double first = mean_position(simulation.lattice()).y();
  advance(simulation, ticks, idle_tool());
  const double second = mean_position(simulation.lattice()).y();
  advance(simulation, ticks, idle_tool());
  const double third = mean_position(simulation.lattice()).y();
  const double measured = -(third - 2.0 * second + first) / (1e-6 * ticks * ticks);
  print_result("free fall", GetParam() + ", " + std::to_string(simulation.substeps()) + " substeps", measured,
               "m/s2");
  EXPECT_NEAR(measured / g, 1.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(, FreeFall, testing::ValuesIn(bundled_material_names()));

}  // namespace
}  // namespace spoonbill
