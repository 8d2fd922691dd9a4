// Tests lattices of bodies such as rings and walled bowls, into which no block of cells can be bent. Such
// bodies are embedded in a box of cells.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/body_coordinates.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice_materials.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/material/block.h"
#include "tests/engine/material/lattice/filled_volume.h"
#include "tests/engine/material/lattice/revolved.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

// Returns half a hollow ball with its mouth up. The meridian runs from the pole at the bottom along the
// outside, around the rim and down the inside; it reaches the rim at the fraction `rim`.
Surface walled_bowl(double radius_m, double wall_m, double rim) {
  return revolved([=](double share) {
    const double edge = 0.5 * wall_m, middle = radius_m - edge;
    constexpr double turn = 0.05;  // fraction of the meridian that each half of the rim takes
    if (share > rim - turn && share < rim + turn) {
      const double angle = 0.5 * pi * (share - rim) / turn;
      return MeridianPlace{middle - edge * std::sin(angle), edge * std::cos(angle)};
    }
    const bool outside = share < rim;
    const double along = outside ? share / (rim - turn) : (1.0 - share) / (1.0 - rim - turn);
    const double out = outside ? radius_m : radius_m - wall_m;
    return MeridianPlace{out * std::sin(0.5 * pi * along), -out * std::cos(0.5 * pi * along)};
  });
}

constexpr double round_ring_m = 0.04, round_tube_m = 0.01;

// Returns the nearest point on the centre line of the ring's tube.
Vector3 middle_of_ring(const Vector3& at) {
  return round_ring_m * Vector3(at.x(), 0.0, at.z()).normalized();
}

TEST(SolidLattice, OfARingHasItsVolumeAndKnowsWhereItsNodesLie) {
  const Surface ring = round_torus(round_ring_m, round_tube_m);
  const LatticeMesh mesh = solid_lattice(ring, {4000, {}}).value();
  // The lattice samples the ring with 80 chords per turn or more, in both directions.
  EXPECT_NEAR(filled_m3(mesh) / (2.0 * pi * pi * round_ring_m * round_tube_m * round_tube_m), 1.0, 0.005);
  const std::vector<BodyCoordinates> places = find_node_coordinates(mesh);
  int inside = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vector3& at = mesh.nodes[n];
    const Vector3 middle = middle_of_ring(at);
    const double depth = round_tube_m - (at - middle).norm();
    if (mesh.node_locations[n] == NodeLocation::outside_body) {
      EXPECT_FALSE(contains({}, places[n])) << n;
      continue;
    }
    EXPECT_TRUE(contains({}, places[n])) << n;
    EXPECT_NEAR(places[n].depth_m, std::max(0.0, depth), 0.02 * round_tube_m);
    if (depth < 0.0 || depth > 0.8 * round_tube_m) continue;
    ++inside;
    const Vector3 nearest = middle + round_tube_m * (at - middle).normalized();
    // The bound is half the diagonal of a cell of the grid of samples, which has 160 or 180 samples per turn.
    EXPECT_LT((position(ring, places[n].around, places[n].along) - nearest).norm(), 0.0012);
  }
  EXPECT_GT(inside, 100);
}

// The test includes cells across the seams, and cells with corners on both sides of the tube's centre line.
TEST(SolidLattice, OfARingKnowsWhereItsCellsLie) {
  const Surface ring = round_torus(round_ring_m, round_tube_m);
  const LatticeMesh mesh = solid_lattice(ring, {4000, {}}).value();
  const std::vector<BodyCoordinates> places = find_cell_coordinates(mesh);
  int filled = 0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        const Vector3 at = trilinear(mesh.cell(i, j, k), 0.5, 0.5, 0.5), middle = middle_of_ring(at);
        const BodyCoordinates& place = places[mesh.cell_index(i, j, k)];
        const double depth = round_tube_m - (at - middle).norm();
        EXPECT_NEAR(place.depth_m, std::max(0.0, depth), 0.02 * round_tube_m);
        if (!mesh.is_filled(i, j, k) || depth > 0.8 * round_tube_m) continue;
        ++filled;
        const Vector3 nearest = middle + round_tube_m * (at - middle).normalized();
        // The bound is half the diagonal of a cell of the grid of samples, which has 160 or 180 samples per
        // turn.
        EXPECT_LT((position(ring, place.around, place.along) - nearest).norm(), 0.0012) << i << j << k;
      }
    }
  }
  EXPECT_GT(filled, 500);
}

// The foot is ten thousand times as stiff as the wall. Cells in the hollow must be as soft as the wall around
// them.
TEST(SolidLattice, TheHollowOfABowlIsOfWhatIsAboutIt) {
  const LatticeMesh mesh = solid_lattice(walled_bowl(0.05, 0.003, 0.65), {2000, {}}).value();
  ASSERT_FALSE(mesh.along.empty());
  MaterialRegion foot;
  foot.region.along = {0.0, 0.1};
  foot.material = elastic_material(1e9, 0.3, 1000.0);
  const LatticeMaterials materials =
      lattice_materials(mesh, elastic_material(1e5, 0.3, 1000.0), {&foot, 1}).value();
  int stiff = 0, in_hollow = 0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        const bool is_foot = materials.index_of(mesh.cell_index(i, j, k)) == 1;
        const Vector3 at = trilinear(mesh.cell(i, j, k), 0.5, 0.5, 0.5);
        const bool hollow = !mesh.is_filled(i, j, k) && at.norm() < 0.045;
        EXPECT_FALSE(is_foot && hollow) << at.transpose();
        stiff += is_foot && mesh.is_filled(i, j, k) ? 1 : 0;
        in_hollow += hollow ? 1 : 0;
      }
    }
  }
  EXPECT_GT(stiff, 3);
  EXPECT_GT(in_hollow, 100);
}

// The region, at the start of u and v, is far smaller than a cell: it contains a part of the skin, but no
// node.
TEST(SolidLattice, ARegionWithoutSurfaceNodesHasNoFriction) {
  MaterialRegion spot;
  spot.region.along = spot.region.around = {0.0, 1e-9};
  spot.friction = 0.9;
  const LatticeMesh mesh = solid_lattice(round_torus(round_ring_m, 0.97 * round_tube_m), {400, {}}).value();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    ASSERT_FALSE(mesh.along[n] <= 1e-9 && mesh.turns[n] <= 1e-9) << "the spot is empty";
  }
  EXPECT_FALSE(lattice_materials(mesh, Material(), {&spot, 1}).ok());
}

// The rim may be anywhere in v. The ring halfway along v may thus be on the outside, on the rim or on the
// inside.
TEST(SolidLattice, OfAWalledBowlHasItsVolume) {
  for (const double rim : {0.35, 0.65}) {
    const Surface bowl = walled_bowl(0.05, 0.003, rim);
    ASSERT_TRUE(check_closed_tube(bowl).ok()) << rim << check_closed_tube(bowl).error().message;
    const Result<LatticeMesh> mesh = solid_lattice(bowl, {2000, {}});
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    EXPECT_NEAR(filled_m3(mesh.value()) / enclosed_volume_m3(bowl), 1.0, 0.02) << rim;
    ASSERT_EQ(mesh->along.size(), mesh->nodes.size()) << "no box of cells";
    for (std::size_t n = 0; n < mesh->nodes.size(); ++n) {
      const double along = mesh->along[n];
      EXPECT_TRUE(mesh->node_locations[n] == NodeLocation::outside_body ? std::isnan(along)
                                                                        : along >= 0.0 && along <= 1.0);
    }
  }
}

TEST(SolidLattice, RunsAlongTheBodyWhereItCan) {
  const LatticeMesh along = solid_lattice(round_ball(0.02), {1000, {}}).value();
  EXPECT_TRUE(along.along.empty());
  EXPECT_EQ(along.nodes, tube_lattice(round_ball(0.02), {1000, {}}).value().nodes);
}

TEST(SolidLattice, RefusesWhatEnclosesNothing) {
  Surface inward = round_torus(0.04, 0.01);
  for (double& y : inward.net.y) y = -y;
  const auto turned = solid_lattice(inward, {2000, {}});
  ASSERT_FALSE(turned.ok());
  EXPECT_EQ(turned.error().code, ErrorCode::inconsistent);
  EXPECT_NE(turned.error().message.find("inward"), std::string::npos) << turned.error().message;
  Surface flat = round_torus(0.04, 0.01);
  for (double& y : flat.net.y) y *= 1e-6;
  const auto thin = solid_lattice(flat, {2000, {}});
  ASSERT_FALSE(thin.ok());
  EXPECT_EQ(thin.error().code, ErrorCode::degenerate) << thin.error().message;
}

}  // namespace
}  // namespace spoonbill
