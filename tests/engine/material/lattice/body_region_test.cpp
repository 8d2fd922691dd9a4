// Compares the body coordinates of nodes and cells with closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/material/lattice/body_coordinates.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/shell_lattice.h"
#include "tests/engine/material/lattice/shells.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

constexpr double length_m = 0.08, bar_radius_m = 0.006;
constexpr int bar_around = 16;

// Returns a round bar along x; u turns from +y to +z, and the ends are flat poles.
Surface round_bar() {
  const std::vector<double> stations = {0.0, 0.0, 0.0, 0.01, 0.02, 0.04, 0.06, 0.07, 0.08, 0.08, 0.08};
  const int along = static_cast<int>(stations.size());
  // A uniform periodic cubic B-spline whose n control points are on a circle has a radius smaller than this
  // circle, by the factor (2 + cos(2 pi / n)) / 3.
  const double outside = 3.0 / (2.0 + std::cos(2.0 * std::numbers::pi / bar_around));
  ControlNet net(bar_around, along);
  for (int i = 0; i < bar_around; ++i) {
    // The offset of 2 puts u = 0 at +y: B_i begins at knot i and is largest at knot i + 2.
    const double angle = 2.0 * std::numbers::pi * (i + 2) / bar_around;
    for (int j = 0; j < along; ++j) {
      const bool pole = j == 0 || j == along - 1;
      const double radius = pole ? 0.0 : outside * bar_radius_m;
      net.set_point(
          i, j, {stations[static_cast<std::size_t>(j)], radius * std::cos(angle), radius * std::sin(angle)});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, bar_around).value(),
                      KnotVector::clamped_uniform(3, along).value(), net)
      .value();
}

LatticeMesh bar_lattice(std::array<int, 3> counts) {
  LatticeRequest request;
  request.counts = counts;
  Result<LatticeMesh> mesh = tube_lattice(round_bar(), request);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  return std::move(mesh).value();
}

// Returns the shorter of the two distances between two positions around the bar, as a fraction of a turn.
double apart(double turn, double other) {
  const double far = std::abs(turn - other);
  return std::min(far, 1.0 - far);
}

// Visits the points in the central half of the bar, away from its caps, with their coordinates and distance
// from the axis.
template <class Visit>
void visit_middle(const std::vector<Vector3>& points, const std::vector<BodyCoordinates>& places,
                  const Visit& visit) {
  ASSERT_EQ(points.size(), places.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double x = points[n].x();
    if (x < 0.25 * length_m || x > 0.75 * length_m) continue;
    visit(points[n], places[n], std::hypot(points[n].y(), points[n].z()));
  }
}

std::vector<Vector3> cell_middles(const LatticeMesh& mesh) {
  std::vector<Vector3> middles(mesh.cell_count(), Vector3::Zero());
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        for (const Vector3& corner : mesh.cell(i, j, k)) middles[mesh.cell_index(i, j, k)] += corner / 8.0;
      }
    }
  }
  return middles;
}

void expect_places_of_a_bar(const std::vector<Vector3>& points, const std::vector<BodyCoordinates>& places,
                            bool of_cells) {
  int seen = 0;
  visit_middle(points, places, [&](const Vector3& point, const BodyCoordinates& place, double from_axis) {
    ++seen;
    // Slices of the lattice are evenly spaced along the bar.
    EXPECT_NEAR(place.along, point.x() / length_m, 0.01);
    // A ring of 24 chords is inside the circle by less than 1 % of its radius. The depth of a cell is the
    // mean depth of its corners; the curvature changes this mean by about as much again.
    EXPECT_NEAR(place.depth_m, bar_radius_m - from_axis, (of_cells ? 0.05 : 0.012) * bar_radius_m);
    if (from_axis < 1e-3 * bar_radius_m) return;
    const double angle = std::atan2(point.z(), point.y()) / (2.0 * std::numbers::pi);
    // Nodes inside the bar are on grid lines of the bent block of cells, which are not exactly radial.
    EXPECT_LT(apart(place.around, angle < 0.0 ? angle + 1.0 : angle), 0.02)
        << point.transpose() << " turn " << place.around;
  });
  EXPECT_GT(seen, 100);
}

TEST(BodyRegion, NodesOfARoundBarAreWhereTheCylinderHasThem) {
  const LatticeMesh mesh = bar_lattice({7, 7, 41});
  expect_places_of_a_bar(mesh.nodes, find_node_coordinates(mesh), false);
}

TEST(BodyRegion, CellsOfARoundBarAreWhereTheCylinderHasThem) {
  for (const int across : {7, 8}) {
    const LatticeMesh mesh = bar_lattice({across, across, 41});
    expect_places_of_a_bar(cell_middles(mesh), find_cell_coordinates(mesh), true);
  }
}

// The depth of a node is its smallest distance from the six faces of the box.
TEST(BodyRegion, DepthInABoxIsTheDistanceToItsNearestFace) {
  const Vector3 size_m(0.012, 0.007, 0.03);
  const LatticeMesh mesh = box_mesh(size_m, {6, 5, 11});
  const std::vector<BodyCoordinates> places = find_node_coordinates(mesh);
  for (std::size_t n = 0; n < places.size(); ++n) {
    const Vector3& point = mesh.nodes[n];
    const double depth = std::min(point.minCoeff(), (size_m - point).minCoeff());
    EXPECT_NEAR(places[n].depth_m, depth, 1e-15);
    EXPECT_NEAR(places[n].along, point.z() / size_m.z(), 1e-15);
    EXPECT_EQ(places[n].around, 0.0);
  }
}

// A ring has no end faces at its seam: the centres of its cells are at half its thickness all the way around.
TEST(BodyRegion, CellsOfAThinRingLieBetweenItsFaces) {
  LatticeRequest request;
  request.counts = {25, 2, 3};
  const Result<LatticeMesh> ring = shell_lattice(open_ring(0.02, 0.006), 0.002, request);
  ASSERT_TRUE(ring.ok()) << ring.error().message;
  const std::vector<BodyCoordinates> places = find_cell_coordinates(ring.value());
  BodyRegion across_seam;
  across_seam.around = {0.9, 0.1};
  int held = 0;
  for (int i = 0; i < 24; ++i) {
    for (int k = 0; k < 2; ++k) {
      const BodyCoordinates& place = places[ring->cell_index(i, 0, k)];
      EXPECT_NEAR(place.around, (i + 0.5) / 24.0, 1e-3);
      EXPECT_NEAR(place.along, 0.25 + 0.5 * k, 1e-12);
      // The chords of 15 degrees on the outer and the inner face are nearer to each other than the arcs, by
      // less than 1 % of the thickness.
      EXPECT_NEAR(place.depth_m, 0.001, 2e-5);
      held += contains(across_seam, place) ? 1 : 0;
    }
  }
  EXPECT_EQ(held, 8) << "the middles of four of 24 cells around, twice";
}

// The test includes those faces of the end caps that have a corner on the axis, where the direction around is
// undefined.
TEST(BodyRegion, FacesOfARoundBarAreWhereTheCylinderHasThem) {
  const LatticeMesh mesh = bar_lattice({7, 7, 41});
  const std::vector<BodyCoordinates> places = find_node_coordinates(mesh);
  int seen = 0;
  for (const ShellFace& face : shell_faces(mesh)) {
    Vector3 middle = Vector3::Zero();
    for (const int node : face) middle += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
    const double turn = std::atan2(middle.z(), middle.y()) / (2.0 * std::numbers::pi);
    const double low = turn - 0.03, high = turn + 0.03;
    BodyRegion region;
    region.around = {low - std::floor(low), high - std::floor(high)};
    EXPECT_EQ(find_faces_in(region, mesh, {face}, places).size(), 1u)
        << middle.transpose() << " turn " << turn;
    ++seen;
  }
  EXPECT_EQ(seen, 2 * 36 + 4 * 6 * 40);
}

TEST(BodyRegion, AroundMayPassTheSeam) {
  BodyRegion region;
  region.around = {0.9, 0.2};
  for (const double inside : {0.9, 0.95, 0.0, 0.1, 0.2}) {
    EXPECT_TRUE(contains(region, {0.5, inside, 0.0})) << inside;
  }
  for (const double outside : {0.21, 0.5, 0.89}) {
    EXPECT_FALSE(contains(region, {0.5, outside, 0.0})) << outside;
  }
  region.around = {0.2, 0.9};
  EXPECT_TRUE(contains(region, {0.5, 0.5, 0.0}));
  EXPECT_FALSE(contains(region, {0.5, 0.1, 0.0}));
}

TEST(BodyRegion, IsCutAlongAndByDepth) {
  const BodyRegion region{{0.5, 0.8}, {0.0, 1.0}, {0.001, 0.002}};
  EXPECT_TRUE(contains(region, {0.5, 0.3, 0.002}));
  EXPECT_FALSE(contains(region, {0.49, 0.3, 0.0015}));
  EXPECT_FALSE(contains(region, {0.81, 0.3, 0.0015}));
  EXPECT_FALSE(contains(region, {0.6, 0.3, 0.0009}));
  EXPECT_FALSE(contains(region, {0.6, 0.3, 0.0021}));
}

// The cells of a region that covers a quarter of a turn fill a quarter of the bar's volume.
TEST(BodyRegion, CellsOfAQuarterTurnHoldAQuarterOfTheBar) {
  const LatticeMesh mesh = bar_lattice({9, 9, 21});
  BodyRegion region;
  region.around = {0.875, 0.125};
  const std::vector<BodyCoordinates> places = find_cell_coordinates(mesh);
  double inside = 0.0, all = 0.0;
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        const double volume = cell_volume(mesh.cell(i, j, k));
        all += volume;
        if (contains(region, places[mesh.cell_index(i, j, k)])) inside += volume;
      }
    }
  }
  // A row of cells on a diagonal of the block is inside or outside as a whole, which limits the precision.
  EXPECT_NEAR(inside / all, 0.25, 0.04);
}

TEST(BodyRegion, WrongOnesAreRefusedByField) {
  const auto refusal = [](const BodyRegion& region) { return Refusal(check_region(region)); };
  EXPECT_TRUE(check_region({}).ok());
  EXPECT_TRUE(check_region({{0.2, 0.4}, {0.9, 0.1}, {0.0, 0.002}}).ok());
  EXPECT_EQ(refusal({{0.7, 0.2}, {0.0, 1.0}, {0.0, 1.0}}), Refusal(ErrorCode::inconsistent, "along"));
  EXPECT_EQ(refusal({{0.0, 1.5}, {0.0, 1.0}, {0.0, 1.0}}), Refusal(ErrorCode::out_of_range, "along"));
  EXPECT_EQ(refusal({{0.0, 1.0}, {0.5, 0.5}, {0.0, 1.0}}), Refusal(ErrorCode::inconsistent, "around"));
  EXPECT_EQ(refusal({{0.0, 1.0}, {0.0, 1.0}, {0.002, 0.001}}).message,
            "depth_mm is [2, 1], must run from 0 or more to the same or a larger depth");
  EXPECT_EQ(refusal({{0.0, 1.0}, {0.0, 1.0}, {-0.001, 0.001}}), Refusal(ErrorCode::inconsistent, "depth_mm"));
  const double nothing = std::nan("");
  EXPECT_FALSE(check_region({{nothing, 1.0}, {0.0, 1.0}, {0.0, 1.0}}).ok());
  EXPECT_FALSE(check_region({{0.0, 1.0}, {0.0, nothing}, {0.0, 1.0}}).ok());
  EXPECT_FALSE(check_region({{0.0, 1.0}, {0.0, 1.0}, {nothing, 1.0}}).ok());
}

}  // namespace
}  // namespace spoonbill
