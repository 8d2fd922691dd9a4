#include "engine/inspection/material_mix.h"

#include <gtest/gtest.h>

#include "engine/shapes/stock_shapes.h"
#include "tests/engine/shapes/body_measures.h"

namespace spoonbill {
namespace {

// A cylinder of 60 mm, upright, its middle at the origin; the lower half lighter.
Body weighted() {
  Body body;
  body.surface = fitted(cylinder_shape({0.01, 0.06, 0.001})).surface;
  body.material.name = "heavy";
  body.material.youngs_modulus_pa = 1e6;
  body.material.poissons_ratio = 0.3;
  body.material.density_kg_per_m3 = 3000.0;
  MaterialRegion lower;
  lower.region.along = {0.0, 0.5};
  lower.material = body.material;
  lower.material->name = "light";
  lower.material->density_kg_per_m3 = 1000.0;
  body.regions = {lower};
  return body;
}

TEST(MaterialMix, IsTheMeanOverTheBody) {
  const auto mix = material_mix(weighted());
  ASSERT_TRUE(mix) << mix.error().message;
  // The cells are whole of one material: half of one layer of some 20 may go either way.
  EXPECT_NEAR(mix->density_kg_per_m3, 2000.0, 100.0);
  EXPECT_EQ(mix->materials, (std::vector<std::string>{"heavy", "light"}));
  // Three quarters of the mass are 15 mm up, a quarter 15 mm down.
  EXPECT_NEAR(mix->from_middle_m.y(), 0.0075, 0.0008);
  EXPECT_NEAR(mix->from_middle_m.x(), 0.0, 1e-5);
  EXPECT_NEAR(mix->from_middle_m.z(), 0.0, 1e-5);
}

TEST(MaterialMix, RefusesWhatHasNoLattice) {
  Body body = weighted();
  for (double& y : body.surface.net.y) y = -y;  // inside out
  EXPECT_FALSE(material_mix(body));
}

}  // namespace
}  // namespace spoonbill
