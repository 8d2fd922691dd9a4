// Tests which bodies count as thinner than two cells when their lattice is a box of cells around them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice/box_lattice.h"
#include "tests/engine/collision/surfaces/sheets.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

constexpr double box_ring_m = 0.02;

// Returns a ring about y with a polygon as its section. The corners are given clockwise, as distances in m
// outwards from the ring's circle and upwards.
Surface edged_ring(const std::vector<std::array<double, 2>>& section) {
  constexpr int along = 24;
  const int around = static_cast<int>(section.size());
  ControlNet net(around, along);
  for (int i = 0; i < around; ++i) {
    const auto [out, up] = section[static_cast<std::size_t>(i)];
    for (int j = 0; j < along; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / along;
      net.set_point(i, j, {(box_ring_m + out) * std::cos(angle), up, -(box_ring_m + out) * std::sin(angle)});
    }
  }
  return make_surface(KnotVector::periodic_uniform(1, around).value(),
                      KnotVector::periodic_uniform(3, along).value(), std::move(net))
      .value();
}

Surface boxed_ring(double wide_m, double high_m) {
  const double out = 0.5 * wide_m, up = 0.5 * high_m;
  return edged_ring({{out, up}, {out, -up}, {-out, -up}, {-out, up}});
}

bool is_slender(const Surface& surface) {
  const Result<LatticeMesh> mesh = surface_in_box(surface, {2000, {}});
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  return mesh->slender;
}

// The cells are 2 to 2.5 mm wide.
TEST(SurfaceInBox, IsSlenderWhereItsSidesAreNearerThanTwoCells) {
  EXPECT_FALSE(is_slender(round_torus(box_ring_m, 0.005)));
  EXPECT_TRUE(is_slender(round_torus(box_ring_m, 0.0015)));
  EXPECT_TRUE(is_slender(boxed_ring(0.01, 0.003)));
  EXPECT_TRUE(is_slender(boxed_ring(0.003, 0.01)));
}

TEST(SurfaceInBox, IsNotSlenderForItsEdges) {
  EXPECT_FALSE(is_slender(boxed_ring(0.01, 0.01)));
  // The section is an equilateral triangle: the faces meet at 60 degrees.
  EXPECT_FALSE(is_slender(edged_ring({{0.0, 0.0115}, {0.01, -0.0058}, {-0.01, -0.0058}})));
}

// A tube, which cells can be bent into.
TEST(SurfaceInBox, IsWhatASolidGetsThatAsksForABox) {
  const Scene handle = small_handle();
  Body body = handle.bodies[0];
  body.lattice = {.counts = std::array{16, 4, 5}, .cells = LatticeCells::box};
  const Result<LatticeMesh> box = make_body_lattice(body);
  ASSERT_TRUE(box.ok()) << box.error().message;
  EXPECT_EQ(box->count, (std::array{16, 4, 5}));
  const Vector3 edges_m = box->nodes.back() - box->nodes.front();
  EXPECT_NEAR(edges_m.x(), 0.06, 1e-3);
  EXPECT_NEAR(edges_m.y(), 0.005, 1e-3);
  EXPECT_NEAR(edges_m.z(), 0.01, 1e-3);
  body.lattice.feature_map = FeatureMapSettings{};
  EXPECT_EQ(check_lattice_request(body.lattice).error().field, "feature_map");
  body.lattice.feature_map.reset();
  body.shell_thickness_m = 0.001;
  EXPECT_EQ(make_body_lattice(body).error().field, "cells");
}

}  // namespace
}  // namespace spoonbill
