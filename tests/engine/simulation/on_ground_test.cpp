// Tests bodies on the rigid ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/simulation/ground_contact.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/material/block.h"
#include "tests/engine/refusal.h"
#include "tests/engine/simulation/handle.h"
#include "tests/engine/simulation/loaded_block.h"
#include "tests/engine/simulation/soft_bodies.h"

namespace spoonbill {
namespace {

constexpr double g_m_per_s2 = 9.81;
constexpr double degree_rad = std::numbers::pi / 180.0;

// A block with its flat side at y = 0, on the ground. Gravity is inclined to the ground's normal.
class Incline {
 public:
  Incline(double angle_rad, double friction, Stepping stepping)
      : block_({0.02, 0.01, 0.03}, {5, 4, 7}, material(stepping), stepping),
        gravity_(g_m_per_s2 * Vector3(std::sin(angle_rad), -std::cos(angle_rad), 0.0)),
        friction_(friction) {}

  void tick() {
    contacts_.begin(Vector3::UnitY(), tick_s);
    const LatticeMesh& mesh = block_.lattice.mesh();
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.grid_index(n)[1] > 0) continue;
      EXPECT_TRUE(contacts_.add(0, block_.lattice, n, block_.lattice.position(n).y(), friction_));
    }
    block_.tick(0.0, gravity_, &contacts_);
  }

  // Applies a force that is distributed over all nodes.
  void push(const Vector3& force_n) { block_.load({ForceLoad{{}, force_n, ForceDistribution::volume}}); }

  // Returns the mean velocity of the block if `velocity` is true, otherwise its mean displacement.
  Vector3 mean(bool velocity) const {
    Vector3 sum = Vector3::Zero();
    const SpringLattice& lattice = block_.lattice;
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      sum +=
          static_cast<double>(lattice.mass(n)) * (velocity ? lattice.velocity(n) : lattice.displacement(n));
    }
    return sum / lattice.mass_kg();
  }

  double deepest_m() const {
    double deepest = 0.0;
    for (const Vector3& position : block_.lattice.positions()) deepest = std::max(deepest, -position.y());
    return deepest;
  }
  Vector3 ground_force_n() const { return contacts_.impulse_ns(0) / tick_s; }
  double weight_n() const { return g_m_per_s2 * block_.lattice.mass_kg(); }

 private:
  static Material material(Stepping stepping) {
    Material material = elastic_material(stepping == Stepping::springs ? 2e4 : 5e6, 0.3, 1000.0);
    material.damping_time_s = 3e-4;
    return material;
  }

  LoadedBlock block_;
  Vector3 gravity_;
  double friction_;
  GroundContacts contacts_{1000};
};

// Returns the mean acceleration along the slope over half a second of sliding, which is many periods of the
// springs.
double acceleration(Incline& incline) {
  for (int tick = 0; tick < 200; ++tick) incline.tick();
  const double before = incline.mean(true).x();
  for (int tick = 0; tick < 500; ++tick) incline.tick();
  return (incline.mean(true).x() - before) / 0.5;
}

double coulomb(double angle_rad, double friction) {
  return g_m_per_s2 * (std::sin(angle_rad) - friction * std::cos(angle_rad));
}

// The acceleration is a = g (sin t - mu cos t) at the angle t and the friction mu. The springs still
// oscillate slightly.
TEST(OnGround, ABlockSlidesDownAnInclineAsCoulombSays) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    for (const double friction : {0.0, 0.2, 0.4}) {
      Incline incline(30.0 * degree_rad, friction, stepping);
      const double allowed = stepping == Stepping::springs ? 0.01 : 1e-3;
      EXPECT_NEAR(acceleration(incline) / coulomb(30.0 * degree_rad, friction), 1.0, allowed) << friction;
      EXPECT_LT(incline.deepest_m(), 5e-6);  // the bound is a thousandth of a cell
    }
  }
}

constexpr double friction_angle = 32.0 * degree_rad;

// The sudden weight makes the block oscillate and slip slightly at first. Afterwards it sticks, except for
// the rounding of its velocities.
TEST(OnGround, ABlockSticksBelowTheAngleOfFriction) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    for (const double angle : {0.8 * friction_angle, friction_angle - degree_rad}) {
      if (angle < friction_angle - degree_rad && !is_full_run()) continue;
      Incline incline(angle, std::tan(friction_angle), stepping);
      for (int tick = 0; tick < 1500; ++tick) incline.tick();
      const double settled = incline.mean(false).x();
      Vector3 force = Vector3::Zero();
      for (int tick = 0; tick < 1000; ++tick) {
        incline.tick();
        force += incline.ground_force_n() / 1000.0;
      }
      EXPECT_NEAR(incline.mean(false).x(), settled, 1e-8) << "in a second, at " << angle / degree_rad;
      EXPECT_NEAR(force.x() / (-incline.weight_n() * std::sin(angle)), 1.0, 1e-3);
      EXPECT_NEAR(force.y() / (incline.weight_n() * std::cos(angle)), 1.0, 1e-3);
    }
  }
}

TEST(OnGround, ABlockSlidesBeyondTheAngleOfFriction) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    for (const double angle : {friction_angle + degree_rad, 1.2 * friction_angle}) {
      Incline incline(angle, std::tan(friction_angle), stepping);
      const double expected = coulomb(angle, std::tan(friction_angle));
      EXPECT_NEAR(acceleration(incline) / expected, 1.0, 0.02) << angle / degree_rad;
    }
  }
}

// A force on the whole block pushes it along level ground.
TEST(OnGround, ABlockPushedSidewaysStaysUntilThePushIsMoreThanItsFriction) {
  for (const Stepping stepping : {Stepping::springs, Stepping::implicitly}) {
    for (const double share : {0.8, 1.2}) {
      Incline incline(0.0, 0.5, stepping);
      incline.push(Vector3(0.5 * share * incline.weight_n(), 0, 0));
      const double expected = share > 1.0 ? g_m_per_s2 * 0.5 * (share - 1.0) : 0.0;
      EXPECT_NEAR(acceleration(incline), expected, std::max(0.05 * expected, 1e-4))
          << "it still swings a little";
    }
  }
}

double lowest_of_skin(const Simulation& simulation) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j <= 120; ++j) {
      const Surface& surface = simulation.surface();
      const double u =
          surface.u.domain_start() + (surface.u.domain_end() - surface.u.domain_start()) * i / 60.0;
      lowest = std::min(lowest, position(surface, u, 0.06 * j / 120.0).y());
    }
  }
  return lowest;
}

constexpr double ground_y_m = -0.006;

Scene falling_handle(double youngs_modulus_pa) {
  Scene scene = small_handle();
  scene.bodies[0].material = silicone();
  scene.bodies[0].material.youngs_modulus_pa = youngs_modulus_pa;
  scene.bodies[0].material.friction = 0.4;
  scene.ground = Ground{Vector3(0, ground_y_m, 0)};
  scene.sculpting.gravity_m_per_s2 = Vector3(0, -g_m_per_s2, 0);
  scene.sculpting.drag_per_s = 4.0;
  scene.tool.substeps = 1;
  return scene;
}

double highest_of_skin(const Simulation& simulation) {
  const Surface& surface = simulation.surface();
  double highest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 240; ++i) {
    const double u =
        surface.u.domain_start() + (surface.u.domain_end() - surface.u.domain_start()) * i / 240.0;
    highest = std::max(highest, position(surface, u, 0.03).y());
  }
  return highest;
}

double depth_cells(const Simulation& simulation) {
  const double ground_m = simulation.scene().ground->point_m.y();
  return (ground_m - lowest_of_skin(simulation)) / static_cast<double>(simulation.lattice().cell_size_m());
}

// Returns the smallest ratio of a cell's volume to its volume at rest.
double least_volume_share(const SpringLattice& lattice) {
  const LatticeMesh& rest = lattice.mesh();
  LatticeMesh now = rest;
  now.nodes = lattice.positions();
  double least = 1.0;
  for (int i = 0; i + 1 < rest.count[0]; ++i) {
    for (int j = 0; j + 1 < rest.count[1]; ++j) {
      for (int k = 0; k + 1 < rest.count[2]; ++k) {
        least = std::min(least, cell_volume(now.cell(i, j, k)) / cell_volume(rest.cell(i, j, k)));
      }
    }
  }
  return least;
}

// The handle is simulated with springs, at two inertia scales, and with the implicit solver.
TEST(OnGround, AHandleThatFallsComesToRestOnItsSkin) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double youngs : {1e4, 2e5, 2e9}) {
    if (youngs == 2e5 && !is_full_run()) continue;
    Simulation simulation = simulate(falling_handle(youngs));
    for (int tick = 0; tick < 1500; ++tick) {
      simulation.advance(far_away);
      if (tick % 10 == 0) {
        ASSERT_LT(depth_cells(simulation), ground_depth_limit_cells) << tick;
      }
    }
    EXPECT_GT(depth_cells(simulation), -ground_depth_limit_cells) << youngs;
    const double weight = g_m_per_s2 * simulation.lattice().mass_kg();
    Vector3 force = Vector3::Zero();
    for (int tick = 0; tick < 500; ++tick) {
      simulation.advance(far_away);
      force += simulation.ground_force_n() / 500.0;
    }
    // The handle still oscillates slightly.
    EXPECT_NEAR(force.y() / weight, 1.0, 0.05) << youngs;
    const Vector3 before = simulation.lattice().position(0);
    for (int tick = 0; tick < 500; ++tick) simulation.advance(far_away);
    EXPECT_LT((simulation.lattice().position(0) - before).norm(), 5e-5) << youngs;
    Snapshot snapshot;
    simulation.write_snapshot(snapshot);
    const auto& touched = snapshot.bodies[0].lattice.touched;
    EXPECT_GT(std::count(touched.begin(), touched.end(), std::uint8_t{1}), 0);
  }
}

// An undone stroke moves the bodies at once. The filter on the height of the skin then starts again.
TEST(OnGround, ForgetsWhereTheSkinWas) {
  Scene scene = falling_handle(1e4);
  const std::vector<BodyState> bodies = [&] {
    std::vector<BodyState> made;
    made.push_back(make_body_state(scene.bodies[0], {}, best_instruction_set()).value());
    return made;
  }();
  const ControlNet& net = bodies[0].mapping().current().net;
  scene.ground->point_m.y() = *std::min_element(net.y.begin(), net.y.end());
  BodyGroundContact contact(bodies);
  const auto count_skin_heights = [&] {
    int heights = 0;
    contact.visit_state([&](const double*, std::size_t count) { heights += count == 1 ? 1 : 0; });
    return heights;
  };
  contact.find(bodies, *scene.ground, scene.sculpting, tick_s);
  // Without the contacts, only the heights of the skin remain in the state.
  contact.contacts().forget();
  EXPECT_GT(count_skin_heights(), 0);
  contact.forget();
  EXPECT_EQ(count_skin_heights(), 0);
}

// Round bodies do not start to roll by themselves.
TEST(OnGround, ASoftHandleAtRestStaysThere) {
  Simulation simulation = simulate(falling_handle(1e4));
  for (int tick = 0; tick < 4000; ++tick) simulation.advance(far_away);
  const Vector3 before = simulation.lattice().position(0);
  for (int tick = 0; tick < 1000; ++tick) simulation.advance(far_away);
  EXPECT_LT((simulation.lattice().position(0) - before).norm(), 5e-6);
}

// Drops handles from 50 cm without air drag: silicones as soft as gels, and one as hard as a plastic. The
// softest arrives at its true speed of 3 m/s; a larger inertia scale makes the others slower.
TEST(OnGround, AFallOfHalfAMetreLeavesNoCellInsideOut) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  for (const double youngs : {4e2, 1e3, 1e9}) {
    if (youngs == 1e3 && !is_full_run()) continue;
    Scene scene = falling_handle(youngs);
    scene.ground->point_m.y() = -0.5;
    scene.sculpting.drag_per_s = 0.0;
    Simulation simulation = simulate(scene);
    for (int tick = 0; tick < 1500; ++tick) {
      simulation.advance(far_away);
      ASSERT_GT(least_volume_share(simulation.lattice()), 0.1) << youngs << ", " << tick;
    }
    EXPECT_LT(depth_cells(simulation), ground_depth_limit_cells) << youngs;
    EXPECT_GT(least_volume_share(simulation.lattice()), 0.8) << youngs;
  }
}

// The handle drops from 27 mm and arrives faster than the speed cap, which limits the speed of nodes relative
// to the body's mean velocity. The skin penetrates the ground slightly and leaves it again.
TEST(OnGround, NoFallIsTooFast) {
  Scene scene = falling_handle(1e4);
  scene.ground->point_m.y() = -0.03;
  scene.tool.substeps = 8;
  Simulation simulation = simulate(scene);
  for (int tick = 0; tick < 1000; ++tick) {
    simulation.advance(far_away);
    ASSERT_LT(depth_cells(simulation), 0.04) << tick;
  }
  EXPECT_LT(depth_cells(simulation), ground_depth_limit_cells);
}

// A hand that presses a body on the ground feels the force that the ground bears beyond the body's weight.
// The tool's spring is far softer than the body and takes up almost the whole distance.
TEST(OnGround, AStiffHandlePassesOnWhatTheToolPresses) {
  Simulation simulation = simulate(falling_handle(2e9));
  for (int tick = 0; tick < 400; ++tick) simulation.advance(far_away);
  const double weight = g_m_per_s2 * simulation.lattice().mass_kg();
  const double tool_radius = simulation.scene().tool.radius_m, top = highest_of_skin(simulation);
  const auto press = [&](double displacement_m) {
    ToolInput input = above(0.03, top + tool_radius - displacement_m);
    input.coupling_n_per_m = 200.0;
    return simulation.advance(input);
  };
  for (int tick = 0; tick < 300; ++tick) press(-2e-4 + 1e-5 * tick);
  for (int tick = 0; tick < 300; ++tick) press(2.8e-3);
  double felt = 0.0, borne = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    felt += press(2.8e-3).force_n.y() / 200.0;
    borne += simulation.ground_force_n().y() / 200.0;
    ASSERT_LT(depth_cells(simulation), ground_depth_limit_cells) << tick;
  }
  EXPECT_NEAR(felt, 200.0 * 2.8e-3, 0.05 * 200.0 * 2.8e-3);
  EXPECT_NEAR((borne - weight) / felt, 1.0, 0.02);
}

// The state, which must be equal, includes the data that contacts store from one tick to the next.
TEST(OnGround, IsTheSameOnEveryInstructionSetAndAllocatesNothing) {
  for (const double youngs : {1e4, 2e9}) {
    Simulation first = simulate(falling_handle(youngs), InstructionSet::baseline);
    Simulation second = simulate(falling_handle(youngs), best_instruction_set());
    first.advance(far_away);
    second.advance(far_away);
    const std::size_t before = allocation_count();
    for (int tick = 0; tick < 400; ++tick) first.advance(far_away);
    EXPECT_EQ(allocation_count(), before);
    for (int tick = 0; tick < 400; ++tick) second.advance(far_away);
    EXPECT_EQ(first.state_hash(), second.state_hash());
  }
}

TEST(OnGround, RefusesWhatIsNoGround) {
  Scene scene = falling_handle(1e4);
  scene.ground->normal = Vector3(0, 2, 0);
  const auto refused = Simulation::make(scene, InstructionSet::baseline);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(Refusal(refused), Refusal(ErrorCode::out_of_range, "normal"));
  scene.ground = Ground{};
  scene.ground->friction = -1.0;
  const auto slippery = Simulation::make(scene, InstructionSet::baseline);
  ASSERT_FALSE(slippery.ok());
  EXPECT_EQ(Refusal(slippery), Refusal(ErrorCode::out_of_range, "friction"));
}

}  // namespace
}  // namespace spoonbill
