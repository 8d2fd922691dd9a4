// Tests stiff bodies under the implicit method against the static solver and closed forms.
#include "engine/material/implicit/implicit_body.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "engine/material/statics/static_solver.h"
#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/effort.h"
#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

ImplicitBody body_of(const LatticeMesh& mesh, const Material& material,
                     InstructionSet set = InstructionSet::baseline) {
  Result<ImplicitBody> body = ImplicitBody::make(mesh, material, set);
  EXPECT_TRUE(body.ok()) << body.error().message;
  return std::move(body).value();
}

Material damped(Material material, double damping_time_s) {
  material.damping_time_s = damping_time_s;
  return material;
}

// A beam along z, fixed at its low end, with a force towards -y at its high end.
struct Cantilever {
  LatticeMesh mesh = box_mesh({0.012, 0.005, 0.1}, {5, 3, 41});
  std::vector<std::uint8_t> held;
  std::vector<FixedAxis> held_axes;
  StaticLoads loads;

  explicit Cantilever(double force_n) : held(static_cast<std::size_t>(mesh.node_count()), 0) {
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 3; ++j) {
        held[static_cast<std::size_t>(mesh.index(i, j, 0))] = 1;
        fix_node(mesh.index(i, j, 0), Vector3::Zero(), held_axes);
        loads.forces.push_back({mesh.index(i, j, 40), Vector3(0.0, -force_n / 15.0, 0.0)});
      }
    }
  }
  int tip() const { return mesh.index(2, 1, 40); }
};

// Beams as stiff as steel and as rubber are bent slightly (load 0.03) and strongly (load 1).
TEST(ImplicitBody, SettlesToTheStaticAnswer) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const double second_moment = 0.012 * std::pow(0.005, 3) / 12.0;
  for (const double youngs : {193e9, 5e6}) {
    for (const double load : {0.03, 1.0}) {
      if ((youngs < 1e9) != (load == 1.0) && !is_full_run()) continue;
      const Cantilever beam(load * youngs * second_moment / 0.01);
      const Material material = damped(elastic_material(youngs, 0.3, 1000.0), 1e-5);
      const StaticBody at_rest = StaticBody::make(beam.mesh, material, CellKind::hexahedra).value();
      const double expected = rest_under_load(at_rest, beam.loads, beam.held_axes)
                                  .value()
                                  .displacement_m[static_cast<std::size_t>(beam.tip())]
                                  .y();
      ImplicitBody body = body_of(beam.mesh, material);
      body.fix_nodes(beam.held);
      for (const NodeForce& force : beam.loads.forces) body.set_node_force(force.node, force.force_n);
      ImplicitStep step;
      step.drag_per_s = 20.0;
      for (int tick = 0; tick < 1000; ++tick) body.step(step);
      // After a second, a drag of 20 per second leaves a smaller fraction of the lowest mode than this bound.
      EXPECT_NEAR(body.displacement(beam.tip()).y() / expected, 1.0, 1e-3) << youngs << " Pa, load " << load;
    }
  }
}

// After n steps h, the body has fallen by g h^2 n (n + 1) / 2, whatever its stiffness.
TEST(ImplicitBody, FallsFreely) {
  ImplicitBody body = body_of(box_mesh({0.02, 0.03, 0.02}, {3, 4, 3}), elastic_material(1e9, 0.3, 1000.0));
  ImplicitStep step;
  step.gravity_m_per_s2 = {0.0, -9.81, 0.0};
  for (int tick = 0; tick < 1000; ++tick) body.step(step);
  for (int n = 0; n < body.node_count(); ++n) {
    EXPECT_NEAR(body.displacement(n).y(), -4.909905, 1e-9);
    EXPECT_NEAR(body.displacement(n).x(), 0.0, 1e-9);
  }
}

// A mode of angular frequency w keeps 1 / (1 + w^2 h^2) of its energy in each step h of the implicit Euler
// method. The base of the cell is fixed.
TEST(ImplicitBody, DampsAModeAsImplicitEulerDoes) {
  const LatticeMesh mesh = box_mesh({0.01, 0.01, 0.01}, {2, 2, 2});
  const Material material = elastic_material(1e5, 0.3, 1000.0);
  ImplicitBody body = body_of(mesh, material);
  // Corners 1, 3, 5 and 7 form the far layer.
  const CellMatrix stiffness = hexahedron_stiffness(mesh.cell(0, 0, 0), 1e5, 0.3);
  Eigen::MatrixXd free(12, 12);
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column) {
      free(row, column) =
          stiffness(3 * (2 * (row / 3) + 1) + row % 3, 3 * (2 * (column / 3) + 1) + column % 3);
    }
  }
  const double mass = 1000.0 * 1e-6 / 8.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(free);
  const double omega = std::sqrt(modes.eigenvalues()[0] / mass);
  std::vector<std::uint8_t> held(8, 0);
  std::array<int, 4> far{};
  for (int c = 0; c < 8; ++c) {
    const int node = mesh.index(c >> 2 & 1, c >> 1 & 1, c & 1);
    if ((c & 1) == 0) {
      held[static_cast<std::size_t>(node)] = 1;
    } else {
      far[static_cast<std::size_t>(c / 2)] = node;
    }
  }
  body.fix_nodes(held);
  // The amplitude is so small that the mode does not rotate the cell.
  constexpr double amplitude_m = 1e-9;
  for (int c = 0; c < 4; ++c) {
    const Eigen::Vector3d shape = modes.eigenvectors().col(0).segment<3>(3 * c);
    body.set_displacement(far[static_cast<std::size_t>(c)], amplitude_m * shape);
  }
  ImplicitStep step;
  step.step_s = 0.1 / omega;
  const auto energy = [&] {
    double sum = 0.0;
    for (const int node : far) {
      sum += omega * omega * body.displacement(node).squaredNorm() + body.velocity(node).squaredNorm();
    }
    return sum;
  };
  const double before = energy();
  for (int k = 0; k < 100; ++k) body.step(step);
  // The expected ratio is (1 + 0.01)^-100.
  EXPECT_NEAR(energy() / before, 0.369711, 1e-4);
}

TEST(ImplicitBody, KeepsItsMomentum) {
  ImplicitBody body = body_of(box_mesh({0.02, 0.01, 0.06}, {4, 3, 11}), elastic_material(1e8, 0.3, 1000.0));
  Random random(3);
  Vector3 before = Vector3::Zero();
  double size = 0.0;
  for (int n = 0; n < body.node_count(); ++n) {
    const Vector3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 2));
    body.set_velocity(n, v);
    before += body.mass_kg(n) * v;
    size += body.mass_kg(n) * v.norm();
  }
  for (int tick = 0; tick < 500; ++tick) body.step({});
  Vector3 after = Vector3::Zero();
  for (int n = 0; n < body.node_count(); ++n) after += body.mass_kg(n) * body.velocity(n);
  EXPECT_LT((after - before).norm(), 1e-5 * size);
}

ImplicitBody steel_bar() {
  return body_of(box_mesh({0.02, 0.01, 0.06}, {4, 3, 11}), elastic_material(193e9, 0.3, 8000.0));
}

Vector3 position(const ImplicitBody& body, int node) {
  return body.mesh().nodes[static_cast<std::size_t>(node)] + body.displacement(node);
}

void spin(ImplicitBody& body, const Vector3& spin_rad_per_s) {
  for (int n = 0; n < body.node_count(); ++n) body.set_velocity(n, spin_rad_per_s.cross(position(body, n)));
}

// About the origin.
Vector3 angular_momentum(const ImplicitBody& body) {
  Vector3 sum = Vector3::Zero();
  for (int n = 0; n < body.node_count(); ++n)
    sum += body.mass_kg(n) * position(body, n).cross(body.velocity(n));
  return sum;
}

double kinetic_energy_j(const ImplicitBody& body) {
  double sum = 0.0;
  for (int n = 0; n < body.node_count(); ++n) sum += 0.5 * body.mass_kg(n) * body.velocity(n).squaredNorm();
  return sum;
}

// A steel bar that spins about an axis of no symmetry keeps its angular momentum, and its kinetic energy but
// for the error of the steps, in each of which it rotates by 0.015 radians.
TEST(ImplicitBody, SpinsFreely) {
  ImplicitBody body = steel_bar();
  spin(body, {8.0, 3.0, 12.0});
  const Vector3 momentum = angular_momentum(body);
  const double energy_j = kinetic_energy_j(body);
  for (int tick = 0; tick < 1000; ++tick) body.step({});
  EXPECT_LT((angular_momentum(body) - momentum).norm(), 1e-4 * momentum.norm());
  EXPECT_NEAR(kinetic_energy_j(body) / energy_j, 1.0, 0.02);
}

// A pair of opposite impulses gives a free body their angular momentum, even if the body has rotated since
// its matrix was factorised.
TEST(ImplicitBody, TakesTheAngularMomentumOfImpulses) {
  ImplicitBody body = steel_bar();
  spin(body, {30.0, 0.0, 0.0});
  for (int tick = 0; tick < 20; ++tick) body.step({});
  body.solve_velocities({});
  const Vector3 before = angular_momentum(body);
  const int first = 0, last = body.node_count() - 1;
  const Vector3 impulse_ns(0.0, 1e-3, 0.0);
  std::vector<double> impulses(3 * static_cast<std::size_t>(body.node_count()), 0.0);
  impulses[1] = -impulse_ns.y();
  impulses[3 * static_cast<std::size_t>(last) + 1] = impulse_ns.y();
  EXPECT_GT(body.respond_to(impulses), 0.0);
  body.apply_response(1.0);
  const Vector3 given = (position(body, last) - position(body, first)).cross(impulse_ns);
  EXPECT_LT((angular_momentum(body) - before - given).norm(), 1e-6 * given.norm());
}

// The nodes are thrown about at up to 20 m/s, with any damping and any stiffness that needs the implicit
// method. All values stay finite, and the body recovers its shape within a second.
TEST(ImplicitBody, NothingBlowsItUp) {
  const int trials = random_cases(is_full_run() ? 8 : 3, 50);
  Random random(11);
  for (int trial = 0; trial < trials; ++trial) {
    const Material material =
        damped(elastic_material(std::pow(10.0, random.uniform(5.0, 12.0)), random.uniform(0.2, 0.49),
                                std::pow(10.0, random.uniform(1.0, 4.0))),
               random.uniform(damping_time_range_s.low, damping_time_range_s.high));
    ImplicitBody body = body_of(box_mesh({0.012, 0.008, 0.05}, {4, 3, 14}), material);
    const double speed = std::pow(10.0, random.uniform(-1.0, 1.3));
    for (int tick = 0; tick < 1500; ++tick) {
      if (tick % 100 == 0 && tick < 500) {
        for (int n = 0; n < body.node_count(); ++n) {
          body.set_velocity(
              n, speed * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        }
      }
      body.step({});
    }
    LatticeMesh shape = body.mesh();
    Vector3 middle = Vector3::Zero();
    for (int n = 0; n < body.node_count(); ++n) {
      ASSERT_TRUE(body.displacement(n).allFinite()) << trial;
      shape.nodes[static_cast<std::size_t>(n)] += body.displacement(n);
      middle += shape.nodes[static_cast<std::size_t>(n)] / body.node_count();
    }
    EXPECT_TRUE(check_cells(shape).ok()) << trial << ": " << check_cells(shape).error().message;
    for (const Vector3& node : shape.nodes) EXPECT_LT((node - middle).norm(), 0.06) << trial;
  }
}

TEST(ImplicitBody, EveryInstructionSetGivesTheSameBits) {
  const Cantilever beam(0.5);
  const Material material = damped(elastic_material(2e9, 0.35, 1000.0), 2e-5);
  const auto shape_after = [&](InstructionSet set) {
    ImplicitBody body = body_of(beam.mesh, material, set);
    body.fix_nodes(beam.held);
    for (const NodeForce& force : beam.loads.forces) body.set_node_force(force.node, force.force_n);
    for (int tick = 0; tick < 30; ++tick) body.step({});
    std::vector<double> state;
    body.visit_state(
        [&](const double* data, std::size_t count) { state.insert(state.end(), data, data + count); });
    return state;
  };
  const std::vector<double> expected = shape_after(InstructionSet::baseline);
  for (const InstructionSet set : available_instruction_sets()) {
    EXPECT_EQ(shape_after(set), expected) << name_of(set);
  }
}

TEST(ImplicitBody, StepsAllocateNothing) {
  ImplicitBody body = body_of(box_mesh({0.02, 0.01, 0.06}, {4, 3, 11}), elastic_material(1e8, 0.3, 1000.0));
  const std::size_t before = allocation_count();
  for (int tick = 0; tick < 20; ++tick) body.step({});
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace spoonbill
