// Tests the self-organising map that spreads nodes through a body.
#include "engine/material/lattice/feature_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

bool is_inside(const LatticeMesh& mesh, int node) {
  const auto [i, j, k] = mesh.grid_index(node);
  return mesh.node_location(i, j, k) == NodeLocation::in_body;
}

// Returns a bar of 6 x 6 x 18 cells that is bent to a quarter of a ring; its cells are uneven and crowded
// towards one side.
LatticeMesh crowded_bend() {
  Random random(6);
  LatticeMesh mesh = box_mesh({1.0, 1.0, 1.0}, {7, 7, 19});
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Vector3 jitter(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (is_inside(mesh, n)) {
      mesh.nodes[static_cast<std::size_t>(n)] += 0.04 * jitter.cwiseProduct(Vector3(1, 1, 0.3));
    }
  }
  for (Vector3& node : mesh.nodes) {
    const double radius = 0.03 + 0.012 * node.x() * (0.4 + 0.6 * node.x()), angle = 1.5 * node.z();
    node = {radius * std::cos(angle), 0.012 * node.y() * (0.5 + 0.5 * node.y()), radius * std::sin(angle)};
  }
  return mesh;
}

TEST(FeatureMap, MakesCellsMoreEvenAndNoneWorse) {
  const LatticeMesh before = crowded_bend();
  LatticeMesh mesh = before;
  FeatureMapSettings settings;
  settings.draws_per_node = 100;
  const FeatureMapReport report = order_by_feature_map(mesh, settings);
  EXPECT_GT(report.applied_fraction, 0.0);
  EXPECT_LT(report.after.volume_spread, 0.9 * report.before.volume_spread);
  EXPECT_GE(report.after.worst_jacobian, report.before.worst_jacobian);
  EXPECT_EQ(report.after.worst_jacobian, measure_cell_quality(mesh).worst_jacobian);
  EXPECT_TRUE(check_cells(mesh).ok());
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    if (is_inside(mesh, n)) continue;
    EXPECT_EQ(mesh.nodes[at], before.nodes[at]) << n;
  }
}

TEST(FeatureMap, GivesTheSameNodesForTheSameSeed) {
  LatticeMesh one = crowded_bend(), same = one, other = one;
  FeatureMapSettings settings;
  settings.draws_per_node = 5;
  order_by_feature_map(one, settings);
  order_by_feature_map(same, settings);
  settings.seed = 2;
  order_by_feature_map(other, settings);
  EXPECT_EQ(one.nodes, same.nodes);
  EXPECT_NE(one.nodes, other.nodes);
}

// At too high rates, the map would fold cells. In this case, only a part of its displacement is applied, or
// none.
TEST(FeatureMap, NeverFoldsACell) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    LatticeMesh mesh = crowded_bend();
    FeatureMapSettings settings;
    settings.draws_per_node = random.integer(1, 30);
    settings.first_rate = settings.last_rate = random.uniform(0.1, 1.0);
    settings.first_neighbourhood = settings.last_neighbourhood = random.uniform(0.5, 2.0);
    settings.seed = static_cast<std::uint32_t>(trial);
    const FeatureMapReport report = order_by_feature_map(mesh, settings);
    EXPECT_TRUE(check_cells(mesh).ok()) << trial;
    EXPECT_GE(measure_cell_quality(mesh).worst_jacobian, report.before.worst_jacobian) << trial;
  }
}

TEST(FeatureMap, CanBeStopped) {
  LatticeMesh mesh = crowded_bend();
  const std::vector<Vector3> before = mesh.nodes;
  double last = -1.0;
  int done = 0;
  const FeatureMapReport report = order_by_feature_map(mesh, {},
                                                       {Progress([&last](double share) {
                                                          EXPECT_GT(share, last);
                                                          last = share;
                                                          return share < 0.1;
                                                        }),
                                                        [&done](const FeatureMapReport&) { ++done; }});
  EXPECT_EQ(done, 0);
  EXPECT_EQ(mesh.nodes, before);
  EXPECT_EQ(report.applied_fraction, 0.0);
  EXPECT_GE(last, 0.1);
}

TEST(FeatureMap, TellsHowItComesAlongAndWhatItMade) {
  LatticeMesh mesh = crowded_bend();
  double last = -1.0;
  FeatureMapReport told;
  const FeatureMapReport report = order_by_feature_map(mesh, {},
                                                       {Progress([&last](double share) {
                                                          last = share;
                                                          return true;
                                                        }),
                                                        [&told](const FeatureMapReport& of) { told = of; }});
  EXPECT_EQ(last, 1.0);
  EXPECT_EQ(told.applied_fraction, report.applied_fraction);
  EXPECT_EQ(told.after.worst_jacobian, measure_cell_quality(mesh).worst_jacobian);
}

TEST(FeatureMap, SettingsHaveRanges) {
  EXPECT_TRUE(check_feature_map({}).ok());
  FeatureMapSettings settings;
  settings.last_rate = std::nan("");
  EXPECT_EQ(Refusal(check_feature_map(settings)), Refusal(ErrorCode::out_of_range, "last_rate"));
  settings = {};
  settings.first_neighbourhood = 0.1;
  EXPECT_FALSE(check_feature_map(settings).ok());
  settings = {};
  settings.draws_per_node = 0;
  EXPECT_FALSE(check_feature_map(settings).ok());
}

}  // namespace
}  // namespace spoonbill
