#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

TEST(Ranges, AcceptTheSample) {
  const Scene scene = sample_document().scene;
  EXPECT_TRUE(check_material(scene.bodies[0].material).ok());
  EXPECT_TRUE(check_tool(scene.tool).ok());
  EXPECT_TRUE(check_sculpting(scene.sculpting).ok());
  EXPECT_TRUE(check_lattice_request(scene.bodies[0].lattice).ok());
  EXPECT_TRUE(check_fixing_plane(scene.planes.front()).ok());
}

TEST(Ranges, NameFieldValueAndRange) {
  Material material = sample_document().scene.bodies[0].material;
  material.poissons_ratio = 0.5;
  EXPECT_EQ(check_material(material).error().message,
            "material modelling-clay: poissons_ratio is 0.5, must be 0 to 0.49");
  material.poissons_ratio = 0.1;
  EXPECT_EQ(
      check_material(material).error().message,
      "material modelling-clay: poissons_ratio is 0.1, must be 0.2 or more for a material that is plastic, "
      "creeps or stiffens");
  material.poissons_ratio = 0.3;
  material.relaxing_fraction = 0.5;
  EXPECT_EQ(
      check_material(material).error().message,
      "material modelling-clay: cannot both flow and creep; set plastic to false or relaxing_share to 0");
  EXPECT_EQ(check_tool({.radius_m = std::nan("")}).error().message,
            "tool: radius_m is nan, must be 0 to 0.5");
  EXPECT_EQ(check_tool({.iterations = 9}).error().message, "tool: iterations is 9, must be 1 to 8");
  EXPECT_EQ(check_sculpting({.damping_per_s = -1.0}).error().message,
            "sculpting: damping_per_s is -1, must be 0 to 1000");
  EXPECT_EQ(check_lattice_request({.counts = {{1, 8, 8}}}).error().message,
            "lattice: nodes[0] is 1, must be 2 to 64");
  EXPECT_EQ(check_fixing_plane({Vector3::Zero(), Vector3::Zero()}).error().message,
            "fixing plane: normal has length 0, must be a unit vector");
}

TEST(Ranges, AskForAYieldStrainOnlyWhereMaterialFlows) {
  Material material = sample_document().scene.bodies[0].material;
  material.yield_strain = 0.0;
  EXPECT_FALSE(check_material(material).ok());
  material.plastic = false;
  EXPECT_TRUE(check_material(material).ok());
}

}  // namespace
}  // namespace spoonbill
