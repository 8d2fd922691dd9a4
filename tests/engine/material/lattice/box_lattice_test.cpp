#include "engine/material/lattice/box_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/springs/spring_lattice.h"
#include "tests/engine/collision/meshes/mesh_shapes.h"
#include "tests/engine/material/block.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

const Material material = elastic_material(1e5, 0.3, 1100.0);

ShellDistance shell_of(const TriangleMesh& mesh) {
  return ShellDistance(mesh.vertices_m, mesh.triangles, ShellDistance::Kind::solid);
}

SpringLattice make_springs(const LatticeMesh& mesh) {
  return SpringLattice::make(mesh, material, InstructionSet::baseline).value();
}

TEST(BoxLattice, OfABoxIsAWholeBlock) {
  const TriangleMesh box = box_of_triangles({-0.01, 0.0, 0.005}, {0.02, 0.02, 0.045});
  const double volume = 0.03 * 0.02 * 0.04;
  const LatticeMesh mesh = box_lattice(shell_of(box), volume, box.vertices_m, {4, 3, 5}).value();
  for (const double share : mesh.cell_fractions) EXPECT_NEAR(share, 1.0, 1e-12);
  const SpringLattice lattice = make_springs(mesh), whole = block({0.03, 0.02, 0.04}, {4, 3, 5}, material);
  EXPECT_NEAR(lattice.mass_kg(), 1100.0 * volume, 1e-12);
  for (int n = 0; n < mesh.node_count(); ++n) {
    EXPECT_NEAR(lattice.mass(n) / whole.mass(n), 1.0, 1e-6);
    EXPECT_LT((mesh.nodes[n] - whole.mesh().nodes[n] - Vector3(-0.01, 0.0, 0.005)).norm(), 1e-15);
  }
}

TEST(BoxLattice, WeighsWhatTheSolidWeighsAndIsNoFasterForItsParts) {
  const TriangleMesh ball = ball_mesh(40, 60, 0.02);
  const double volume = 4.0 / 3.0 * std::numbers::pi * 0.02 * 0.02 * 0.02;
  const LatticeMesh mesh = box_lattice(shell_of(ball), volume, ball.vertices_m, {9, 9, 9}).value();
  const SpringLattice lattice = make_springs(mesh), whole = block({0.04, 0.04, 0.04}, {9, 9, 9}, material);
  EXPECT_NEAR(lattice.mass_kg() / (1100.0 * volume), 1.0, 1e-12);
  double sum = 0.0;
  Vector3 middle = Vector3::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int n = 0; n < mesh.node_count(); ++n) {
    const double mass = static_cast<double>(lattice.mass(n));
    sum += mass;
    middle += mass * mesh.nodes[n];
    inertia += mass * mesh.nodes[n] * mesh.nodes[n].transpose();
  }
  EXPECT_NEAR(sum / lattice.mass_kg(), 1.0, 1e-6);
  EXPECT_LT((middle / sum).norm(), 1e-3 * 0.02) << "in its middle";
  // For a ball, the sum of mass times squared coordinate is m r^2 / 5 along each axis. The lattice has its
  // mass at the corners of cells that are a quarter of the radius wide. Its mass is therefore farther out
  // than the mass of the ball, which increases the sum by a twentieth. Partly filled cells increase it by as
  // much again.
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(inertia(axis, axis) / (sum * 0.02 * 0.02 / 5.0), 1.0, 0.15);
  }
  EXPECT_LT(lattice.fastest_frequency(), 1.001 * whole.fastest_frequency());
  // The central cell is entirely filled. Its fraction may be slightly less than 1: cells with little material
  // get a minimum fraction, and then all fractions are scaled to the volume of the body.
  EXPECT_NEAR(mesh.cell_fraction(4, 4, 4), 1.0, 0.05);
  EXPECT_LT(mesh.cell_fraction(0, 0, 0), 2e-3) << "the ball does not reach the box's corner";
}

TEST(BoxLattice, EmbedsPointsWhereTheyAre) {
  Random random(3);
  const TriangleMesh box = box_of_triangles({-0.01, 0.0, 0.005}, {0.02, 0.02, 0.045});
  const LatticeMesh mesh = box_lattice(shell_of(box), 2.4e-5, box.vertices_m, {4, 3, 5}).value();
  SpringLattice lattice = make_springs(mesh);
  Eigen::Matrix3d turn;
  turn << 0.1, 0.02, -0.03, 0.01, -0.05, 0.04, 0.03, 0.02, 0.07;
  const Vector3 shift(0.004, -0.002, 0.001);
  for (int n = 0; n < mesh.node_count(); ++n) lattice.set_displacement(n, shift + turn * mesh.nodes[n]);
  for (int p = 0; p < 100; ++p) {
    const Vector3 point(random.uniform(-0.01, 0.02), random.uniform(0.0, 0.02), random.uniform(0.005, 0.045));
    const EmbeddedPoint embedded = embed_in_box(mesh, point);
    // Positions of some centimetres are stored in single precision.
    EXPECT_LT((embedded.rest_m(lattice) - point).norm(), 2e-8);
    const Vector3 moved = embedded.displacement_m(lattice.view());
    EXPECT_LT((moved - shift - turn * point).norm(), 1e-8) << "linear fields are kept";
  }
}

TEST(BoxLattice, RefusesWhatIsTooFlat) {
  const TriangleMesh box = box_of_triangles({0, 0, 0}, {0.1, 0.1, 1e-6});
  const auto refused = box_lattice(shell_of(box), 1e-8, box.vertices_m, {3, 3, 3});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(Refusal(refused), Refusal(ErrorCode::degenerate, "mesh"));
}

TEST(LatticeRequest, CountsCellsThatAreNearlyCubes) {
  const auto counts = lattice_counts({1000, {}}, {0.03, 0.02, 0.06}).value();
  EXPECT_LE(counts[0] * counts[1] * counts[2], 1000);
  EXPECT_GE(counts[0] * counts[1] * counts[2], 800);
  EXPECT_NEAR(0.03 / (counts[0] - 1) / (0.02 / (counts[1] - 1)), 1.0, 0.2);
  EXPECT_NEAR(0.03 / (counts[0] - 1) / (0.06 / (counts[2] - 1)), 1.0, 0.2);
  EXPECT_FALSE(lattice_counts({1000, {{1, 4, 4}}}, {0.03, 0.02, 0.06}).ok());
}

}  // namespace
}  // namespace spoonbill
