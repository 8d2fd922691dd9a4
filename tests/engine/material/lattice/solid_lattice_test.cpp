// Bodies that no block of cells can be bent into lie in a box of cells: rings, and bowls with a wall.
#include "engine/material/lattice/solid_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/lattice/body_region.h"
#include "engine/material/lattice/closed_surface.h"
#include "engine/material/lattice/tube_lattice.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/material/lattice/revolved.h"

namespace spoonbill {
namespace {

constexpr double pi = std::numbers::pi;

// Half a hollow ball, its mouth up: from the pole below along the outside, round the rim and down the inside.
// `rim` is the share of the meridian that reaches the rim.
Surface walled_bowl(double radius_m, double wall_m, double rim) {
  return revolved([=](double share) {
    const double edge = 0.5 * wall_m, middle = radius_m - edge;
    constexpr double turn = 0.05;  // of the meridian, for each half of the rim
    if (share > rim - turn && share < rim + turn) {
      const double angle = 0.5 * pi * (share - rim) / turn;
      return MeridianPoint{middle - edge * std::sin(angle), edge * std::cos(angle)};
    }
    const bool outside = share < rim;
    const double along = outside ? share / (rim - turn) : (1.0 - share) / (1.0 - rim - turn);
    const double out = outside ? radius_m : radius_m - wall_m;
    return MeridianPoint{out * std::sin(0.5 * pi * along), -out * std::cos(0.5 * pi * along)};
  });
}

double filled_m3(const LatticeMesh& mesh) {
  double volume = 0.0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        volume += mesh.share(i, j, k) * cell_volume(mesh.cell(i, j, k));
      }
    }
  }
  return volume;
}

TEST(SolidLattice, OfARingHasItsVolumeAndKnowsWhereItsNodesLie) {
  constexpr double ring_m = 0.04, tube_m = 0.01;
  const Surface ring = round_torus(ring_m, tube_m);
  const LatticeMesh mesh = solid_lattice(ring, {4000, {}}).value();
  // Chords of 80 and more a turn, in both directions.
  EXPECT_NEAR(filled_m3(mesh) / (2.0 * pi * pi * ring_m * tube_m * tube_m), 1.0, 0.005);
  const std::vector<BodyPlace> places = node_places(mesh);
  int inside = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vector3& at = mesh.nodes[n];
    const double out = std::hypot(at.x(), at.z()) - ring_m, depth = tube_m - std::hypot(out, at.y());
    EXPECT_NEAR(places[n].depth_m, mesh.places[n] == NodePlace::beside_body ? 0.0 : std::max(0.0, depth),
                0.02 * tube_m);
    if (depth < 0.0 || depth > 0.8 * tube_m) continue;
    ++inside;
    const Vector3 middle = ring_m * Vector3(at.x(), 0.0, at.z()).normalized();
    const Vector3 nearest = middle + tube_m * (at - middle).normalized();
    // Half the diagonal of a cell of the samples: 160 and 180 a turn.
    EXPECT_LT((position(ring, places[n].around, places[n].along) - nearest).norm(), 0.0012);
  }
  EXPECT_GT(inside, 100);
}

// Wherever the rim is in v: a ring in the middle may lie on the outside, on the rim or on the inside.
TEST(SolidLattice, OfAWalledBowlHasItsVolume) {
  for (const double rim : {0.35, 0.65}) {
    const Surface bowl = walled_bowl(0.05, 0.003, rim);
    ASSERT_TRUE(check_closed_tube(bowl).ok()) << rim << check_closed_tube(bowl).error().message;
    const Result<LatticeMesh> mesh = solid_lattice(bowl, {2000, {}});
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    EXPECT_NEAR(filled_m3(mesh.value()) / enclosed_volume_m3(bowl), 1.0, 0.02) << rim;
    for (const double along : mesh->along) EXPECT_TRUE(along >= 0.0 && along <= 1.0);
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
  EXPECT_NE(turned.error().message.find("normals point inward; reverse"), std::string::npos);
  Surface flat = round_torus(0.04, 0.01);
  for (double& y : flat.net.y) y *= 1e-6;
  const auto thin = solid_lattice(flat, {2000, {}});
  ASSERT_FALSE(thin.ok());
  EXPECT_NE(thin.error().message.find("too flat for a lattice"), std::string::npos) << thin.error().message;
}

}  // namespace
}  // namespace spoonbill
