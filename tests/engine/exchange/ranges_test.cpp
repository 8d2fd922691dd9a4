#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

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
  EXPECT_EQ(Refusal(check_material(material)), Refusal(ErrorCode::out_of_range, "poissons_ratio"));
  material.poissons_ratio = 0.1;
  EXPECT_EQ(Refusal(check_material(material)), Refusal(ErrorCode::out_of_range, "poissons_ratio"));
  material.poissons_ratio = 0.3;
  material.relaxing_fraction = 0.5;
  EXPECT_EQ(Refusal(check_material(material)), Refusal(ErrorCode::inconsistent, "plastic"));
  EXPECT_EQ(check_tool({.radius_m = std::nan("")}).error().message,
            "tool: radius_m is nan, must be from 0 to 0.5");
  EXPECT_EQ(Refusal(check_tool({.substeps = 9})), Refusal(ErrorCode::out_of_range, "substeps"));
  EXPECT_EQ(Refusal(check_sculpting({.drag_per_s = -1.0})), Refusal(ErrorCode::out_of_range, "drag_per_s"));
  EXPECT_EQ(Refusal(check_lattice_request({.counts = {{1, 8, 8}}})),
            Refusal(ErrorCode::out_of_range, "nodes[0]"));
  EXPECT_EQ(Refusal(check_fixing_plane({Vector3::Zero(), Vector3::Zero()})),
            Refusal(ErrorCode::out_of_range, "normal"));
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
