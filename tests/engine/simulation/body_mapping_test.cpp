// Tests that the surface of a body follows the rigid motions of its lattice.
#include "engine/simulation/body_mapping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/material/lattice/body_lattice.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/stock_shapes.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

Body stock_body(const std::string& name, const StockShapeSize& size, int node_budget) {
  const ExactShape shape = stock_shape(size).value();
  ShapeFit fit;
  fit.tolerance_m = default_tolerance_m(shape);
  Body body;
  body.name = name;
  body.surface = fit_shape(shape, fit).value().surface;
  body.material.youngs_modulus_pa = 1e5;
  body.material.poissons_ratio = 0.45;
  body.material.density_kg_per_m3 = 1000.0;
  body.lattice.node_budget = node_budget;
  return body;
}

// Returns the largest distance of a control point from where a rigid motion of all nodes puts it.
double misfit_after_turn(const Body& body) {
  const auto mesh = make_body_lattice(body);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  auto made = SpringLattice::make(mesh.value(), LatticeMaterials{body.material}, best_instruction_set());
  EXPECT_TRUE(made.ok()) << made.error().message;
  SpringLattice lattice = std::move(made).value();
  auto mapping = BodyMapping::make(body.surface, body.surface, lattice, {}, best_instruction_set());
  EXPECT_TRUE(mapping.ok()) << mapping.error().message;
  const Pose turn{Vector3(0.01, -0.02, 0.005),
                  Quaternion(Eigen::AngleAxisd(1.0, Vector3(1.0, 2.0, -2.0) / 3.0))};
  const auto turned = [&](const Vector3& rest) -> Vector3 {
    return turn.position_m + turn.orientation * rest;
  };
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const Vector3& rest = lattice.mesh().nodes[static_cast<std::size_t>(n)];
    lattice.set_displacement(n, turned(rest) - rest);
  }
  mapping->update(lattice);
  double misfit_m = 0.0;
  const ControlNet &rest = mapping->rest().net, &current = mapping->current().net;
  for (int i = 0; i < rest.rows; ++i) {
    for (int j = 0; j < rest.columns; ++j) {
      misfit_m = std::max(misfit_m, (current.point(i, j) - turned(rest.point(i, j))).norm());
    }
  }
  return misfit_m;
}

// Coarse lattices leave parts of a body outside their cells, up to more than a cell away.
TEST(BodyMapping, FollowsATurnOfTheLattice) {
  std::vector<Body> bodies;
  for (const int budget : {60, 150, 200, 300, 400}) {
    if (sanitized && budget > 60) break;
    bodies.push_back(stock_body("box", BoxSize{{0.0216, 0.0222, 0.018}, 0.001}, budget));
    bodies.push_back(stock_body("long box", BoxSize{{0.03, 0.012, 0.015}, 0.002}, budget));
    bodies.push_back(stock_body("cone", ConeSize{0.012, 0.018, 0.003, 0.001}, budget));
    bodies.push_back(stock_body("plate", PlateSize{0.04, 0.03, 0.003, 0.004}, budget));
    bodies.push_back(stock_body("rod", BoxSize{{0.1, 0.006, 0.006}, 0.001}, budget));
    bodies.push_back(stock_body("bowl", BowlSize{0.06, 0.042, 0.01, 0.003}, budget));
    bodies.push_back(stock_body("boxed", BoxSize{{0.0216, 0.0222, 0.018}, 0.001}, budget));
    bodies.back().lattice.cells = LatticeCells::box;
  }
  for (const Body& body : bodies) {
    // Displacements of up to 0.1 m and weights are stored in single precision.
    EXPECT_LT(misfit_after_turn(body), 5e-7) << body.name << " of " << body.lattice.node_budget << " nodes";
  }
}

}  // namespace
}  // namespace spoonbill
