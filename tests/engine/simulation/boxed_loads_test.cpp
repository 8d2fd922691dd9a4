// Tests that loads and supports of bodies that are embedded in a box of cells act on the body, not on the
// box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/material/lattice/body_lattice.h"
#include "engine/material/statics/static_solver.h"
#include "engine/simulation/body_loads.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/rest_shape.h"
#include "tests/engine/allocations.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/material/block.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

using std::numbers::pi;
constexpr double ring_m = 0.03, tube_m = 0.01;

// Returns a ring about y. The body coordinate `around` runs about y, and `along` runs about the tube.
const LatticeMesh& ring_in_box() {
  static const LatticeMesh mesh = solid_lattice(round_torus(ring_m, tube_m), {3000, {}}).value();
  return mesh;
}

BodyLoads loads_on(const LatticeMesh& mesh, const std::vector<Load>& loads) {
  return BodyLoads::make(loads, mesh, [](double, double) { return EmbeddedPoint(); }).value();
}

SpringLattice springs(const LatticeMesh& mesh) {
  return SpringLattice::make(mesh, elastic_material(1e5, 0.3, 1000.0), InstructionSet::baseline).value();
}

Vector3 applied_n(const SpringLattice& lattice, int node) {
  return {lattice.applied_force(0)[node], lattice.applied_force(1)[node], lattice.applied_force(2)[node]};
}

struct NetForce {
  Vector3 force_n = Vector3::Zero(), moment_nm = Vector3::Zero();
  double sum_n = 0.0;  // sum of the magnitudes of the forces
};

NetForce net_of(const SpringLattice& lattice) {
  NetForce net;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const Vector3 force = applied_n(lattice, n);
    net.force_n += force;
    net.moment_nm += lattice.position(n).cross(force);
    net.sum_n += force.norm();
  }
  return net;
}

void expect_on_the_body(const SpringLattice& lattice) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.mesh().node_locations[static_cast<std::size_t>(n)] != NodeLocation::outside_body) continue;
    EXPECT_EQ(applied_n(lattice, n).norm(), 0.0) << n;
  }
}

// The forces balance for any shape of the ring, up to single precision.
TEST(BoxedLoads, PressureAllAroundNeitherMovesNorTurnsABody) {
  const LatticeMesh& mesh = ring_in_box();
  SpringLattice lattice = springs(mesh);
  BodyLoads loads = loads_on(mesh, {PressureLoad{{}, 500.0}});
  for (const double bend : {0.0, 0.2}) {
    for (int n = 0; n < mesh.node_count(); ++n) {
      const Vector3& at = mesh.nodes[static_cast<std::size_t>(n)];
      const double displacement_m = bend * ring_m;
      lattice.set_displacement(
          n, {displacement_m * std::sin(60.0 * at.y()), displacement_m * std::cos(70.0 * at.x()),
              displacement_m * std::sin(50.0 * (at.x() + at.z()))});
    }
    const std::size_t allocations = allocation_count();
    loads.apply(lattice, nullptr);
    EXPECT_EQ(allocation_count(), allocations);
    const NetForce net = net_of(lattice);
    EXPECT_GT(net.sum_n, 0.5 * 500.0 * 4.0 * pi * pi * ring_m * tube_m);
    EXPECT_LT(net.force_n.norm(), 1e-6 * net.sum_n) << bend;
    EXPECT_LT(net.moment_nm.norm(), 1e-6 * ring_m * net.sum_n) << bend;
    expect_on_the_body(lattice);
  }
}

// The pressure on half a ring equals a pressure on the two discs where it is cut. The skin's polygons about
// the tube are a few percent smaller than its circle.
TEST(BoxedLoads, PressureOnAHalfPushesAsOnItsCuts) {
  const LatticeMesh& mesh = ring_in_box();
  SpringLattice lattice = springs(mesh);
  BodyRegion half;
  half.around = {0.25, 0.75};
  loads_on(mesh, {PressureLoad{half, 500.0}}).apply(lattice, nullptr);
  const NetForce net = net_of(lattice);
  EXPECT_NEAR(net.force_n.norm() / (500.0 * 2.0 * pi * tube_m * tube_m), 1.0, 0.04);
  const Surface ring = round_torus(ring_m, tube_m);
  const Vector3 middle = position(ring, 0.5, 0.0);
  const Vector3 outward = Vector3(middle.x(), 0.0, middle.z()).normalized();
  EXPECT_LT(outward.dot(net.force_n.normalized()), -0.99) << "inward, for the outer side is the longer one";
  expect_on_the_body(lattice);
}

Vector3 at_node(const LatticeMesh& mesh, const std::vector<Vector3>& moved, int node) {
  return mesh.nodes[static_cast<std::size_t>(node)] + moved[static_cast<std::size_t>(node)];
}

double skin_volume_m3(const LatticeMesh& mesh, const std::vector<Vector3>& moved) {
  const auto at = [&](std::uint32_t point) {
    Vector3 sum = Vector3::Zero();
    const CellPoint& follows = mesh.skin.points[point];
    for (std::size_t c = 0; c < 8; ++c) sum += follows.weights[c] * at_node(mesh, moved, follows.nodes[c]);
    return sum;
  };
  double volume = 0.0;
  for (const BodySkin::Triangle& t : mesh.skin.triangles)
    volume += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0;
  return volume;
}

// Fixes six coordinates of three nodes, which prevents rigid motion only. The fixed coordinates bear no force
// if the loads balance.
std::vector<FixedAxis> held_loosely(const LatticeMesh& mesh) {
  const auto nearest = [&](const Vector3& place) {
    int best = 0;
    for (int n = 1; n < mesh.node_count(); ++n) {
      if ((mesh.nodes[static_cast<std::size_t>(n)] - place).norm() <
          (mesh.nodes[static_cast<std::size_t>(best)] - place).norm()) {
        best = n;
      }
    }
    return best;
  };
  const int a = nearest({ring_m, 0, 0}), b = nearest({-ring_m, 0, 0}), c = nearest({0, 0, ring_m});
  return {{a, 0, 0.0}, {a, 1, 0.0}, {a, 2, 0.0}, {b, 1, 0.0}, {b, 2, 0.0}, {c, 1, 0.0}};
}

// The strain of a volume under uniform pressure p is 3 (1 - 2 nu) p / E. A partly filled cell is as stiff as
// if its material were spread over the cell; less than a tenth of material counts as a tenth.
TEST(BoxedLoads, PressureAllAroundShrinksARing) {
  const LatticeMesh& mesh = ring_in_box();
  const double youngs = 1e5, poisson = 0.3, share = 1e-3;
  const BodyLoads loads = loads_on(mesh, {PressureLoad{{}, share * youngs}});
  const StaticBody body =
      StaticBody::make(mesh, elastic_material(youngs, poisson, 1000.0), CellKind::hexahedra).value();
  const StaticResult rest =
      rest_under_load(body, {Vector3::Zero(), loads.forces(), loads.pressures(), loads.pressed_skin()},
                      held_loosely(mesh))
          .value();
  const std::vector<Vector3> still(mesh.nodes.size(), Vector3::Zero());
  const double before = skin_volume_m3(mesh, still);
  EXPECT_NEAR(before / (2.0 * pi * pi * ring_m * tube_m * tube_m), 1.0, 0.04);
  const double change = skin_volume_m3(mesh, rest.displacement_m) / before - 1.0;
  EXPECT_NEAR(change / (-3.0 * (1.0 - 2.0 * poisson) * share), 1.0, 0.1);
  Vector3 reaction = Vector3::Zero();
  for (const Vector3& n : rest.reaction_n) reaction += n;
  EXPECT_LT(reaction.norm(), 1e-6 * share * youngs * ring_m * tube_m);
}

TEST(BoxedLoads, AForceOnAPartIsAllOnThatPart) {
  const LatticeMesh& mesh = ring_in_box();
  const Vector3 force_n(0.1, -0.2, 0.3);
  BodyRegion quarter;
  quarter.around = {0.25, 0.5};
  const Vector3 middle = position(round_torus(ring_m, tube_m), 0.375, 0.0);
  for (const ForceDistribution shared_by : {ForceDistribution::surface, ForceDistribution::volume}) {
    SpringLattice lattice = springs(mesh);
    loads_on(mesh, {ForceLoad{quarter, force_n, shared_by}}).apply(lattice, nullptr);
    EXPECT_LT((net_of(lattice).force_n - force_n).norm(), 1e-6);
    expect_on_the_body(lattice);
    Vector3 centre = Vector3::Zero();
    for (int n = 0; n < mesh.node_count(); ++n) {
      centre += applied_n(lattice, n).norm() / force_n.norm() * mesh.nodes[static_cast<std::size_t>(n)];
    }
    // The centre of a quarter turn is at 2 sqrt(2) / pi of the radius, plus a term with the square of the
    // tube's radius, because the outer side is longer. A cell is 3 mm long.
    EXPECT_NEAR(centre.norm(), 2.0 * std::numbers::sqrt2 / pi * ring_m, 0.1 * ring_m);
    EXPECT_GT(Vector3(middle.x(), 0.0, middle.z()).normalized().dot(centre.normalized()), 0.999);
  }
}

TEST(BoxedLoads, ASupportHoldsNothingBesideTheBody) {
  const LatticeMesh& mesh = ring_in_box();
  for (const BodyRegion& region : {BodyRegion{{0.0, 0.1}}, BodyRegion{}}) {
    const SpringLattice lattice = springs(mesh);
    BodySupports supports = BodySupports::make({Support{region, {}}}, mesh).value();
    std::vector<std::uint8_t> held(mesh.nodes.size(), 0);
    supports.claim_nodes(lattice, held);
    EXPECT_GT(std::accumulate(held.begin(), held.end(), 0), 20);
    for (std::size_t n = 0; n < held.size(); ++n) {
      EXPECT_FALSE(held[n] != 0 && mesh.node_locations[n] == NodeLocation::outside_body) << n;
    }
  }
}

// Springs and implicit solver both have the weight of the ring, not of the box. The skin's triangles, over a
// hundred per turn, omit less than a thousandth of the volume.
TEST(BoxedLoads, ABodyWeighsWhatItIs) {
  Body body = small_handle().bodies[0];
  body.surface = round_torus(ring_m, tube_m);
  body.material = elastic_material(2e9, 0.3, 1000.0);
  const BodyState state = make_body_state(body, {}, InstructionSet::baseline).value();
  ASSERT_TRUE(state.implicit_solver.has_value());
  const double mass_kg = 1000.0 * 2.0 * pi * pi * ring_m * tube_m * tube_m;
  EXPECT_NEAR(state.lattice.mass_kg() / mass_kg, 1.0, 2e-3);
  const LatticeMesh& block = state.implicit_solver->mesh();
  double of_block_kg = 0.0;
  for (int k = 0; k + 1 < block.count[2]; ++k) {
    for (int i = 0; i + 1 < block.count[0]; ++i) {
      for (int j = 0; j + 1 < block.count[1]; ++j) {
        of_block_kg += 1000.0 * block.cell_fraction(i, j, k) * cell_volume(block.cell(i, j, k));
      }
    }
  }
  // Each cell of the block gets the mean filled fraction of the lattice's cells that it overlaps, so the mass
  // is conserved.
  EXPECT_NEAR(of_block_kg / mass_kg, 1.0, 0.05);
}

TEST(BoxedLoads, RemarksTellOfTheBoxAndOfItsCells) {
  Body body = small_handle().bodies[0];
  body.surface = round_torus(ring_m, tube_m);
  for (const bool slender : {false, true}) {
    if (slender) body.lattice.counts = {5, 4, 40};
    const std::string warning =
        describe_lattice_warning(make_body_state(body, {}, InstructionSet::baseline).value(), body.lattice);
    EXPECT_NE(warning.find("nodes are counted along x, y and z"), std::string::npos) << warning;
    EXPECT_EQ(warning.find("cells are too slender") != std::string::npos, slender) << warning;
  }
}

TEST(BoxedLoads, NoRemarkTellsOfABoxThatWasAskedFor) {
  Body body = small_handle().bodies[0];
  body.lattice = {.counts = std::array{25, 4, 6}, .cells = LatticeCells::box};
  EXPECT_EQ(
      describe_lattice_warning(make_body_state(body, {}, InstructionSet::baseline).value(), body.lattice),
      "");
}

// A ring that is fixed on one side moves farthest on the other. The corners of the box beyond the ring move
// farther, but are not part of the body.
TEST(BoxedLoads, RestTellsWhatTheBodyDoes) {
  Scene scene = small_handle();
  Body& body = scene.bodies[0];
  body.surface = round_torus(ring_m, tube_m);
  body.lattice = {2000, {}};
  body.material = elastic_material(1e5, 0.3, 1000.0);
  body.loads = {PressureLoad{{}, 100.0}};
  scene.planes = {{Vector3(-ring_m, 0.0, 0.0), Vector3::UnitX()}};
  scene.sculpting.gravity_m_per_s2 = {0.0, 0.0, -9.81};
  const Result<RestShape> rest = compute_rest_shape(scene, 0);
  ASSERT_TRUE(rest.ok()) << rest.error().message;
  const LatticeMesh& mesh = rest->mesh;
  const std::vector<Vector3>& moved = rest->result.displacement_m;
  const auto furthest = std::max_element(
      moved.begin(), moved.end(), [](const Vector3& a, const Vector3& b) { return a.norm() < b.norm(); });
  ASSERT_EQ(mesh.node_locations[static_cast<std::size_t>(furthest - moved.begin())],
            NodeLocation::outside_body);
  EXPECT_NE(mesh.node_locations[static_cast<std::size_t>(rest->furthest_node)], NodeLocation::outside_body);
  const double from_tube = std::hypot(
      std::hypot(rest->largest_strain_position_m.x(), rest->largest_strain_position_m.z()) - ring_m,
      rest->largest_strain_position_m.y());
  // A cell that contains some of the ring extends beyond it by at most its diagonal.
  EXPECT_LT(from_tube, tube_m + std::numbers::sqrt3 * mesh.mean_edge());
  const double weight_n = 2.0 * pi * pi * ring_m * tube_m * tube_m * 1000.0 * 9.81;
  // Cells outside the ring weigh only a thousandth of filled ones, and the pressure has no resultant force.
  EXPECT_NEAR(rest->load_n.z() / -weight_n, 1.0, 0.01);
  EXPECT_LT((rest->load_n + rest->reaction_n).norm(), 1e-4 * weight_n);
}

}  // namespace
}  // namespace spoonbill
