// Tests the materials that regions give to cells and nodes.
#include "engine/material/lattice_materials.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/material/block.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

const Vector3 size_m(0.01, 0.01, 0.02);

LatticeMesh bar() {
  return box_mesh(size_m, {6, 6, 11});  // the cells are cubes of 2 mm
}

Material named(const char* name, double youngs_modulus_pa, double friction) {
  Material material = elastic_material(youngs_modulus_pa, 0.3, 1000.0);
  material.name = name;
  material.friction = friction;
  return material;
}

LatticeMaterials made_of(const std::vector<MaterialRegion>& regions) {
  Result<LatticeMaterials> materials = lattice_materials(bar(), named("own", 1e6, 0.2), regions);
  EXPECT_TRUE(materials.ok()) << materials.error().message;
  return std::move(materials).value();
}

TEST(LatticeMaterials, WithoutRegionsThereIsOne) {
  const LatticeMaterials materials = made_of({});
  EXPECT_FALSE(materials.has_several_materials());
  EXPECT_EQ(materials.of(17).name, "own");
  EXPECT_EQ(materials.friction(17), 0.2);
}

// The bar has 5 x 5 x 10 cells; a skin of one cell leaves 3 x 3 x 8 cells inside.
TEST(LatticeMaterials, ASkinTakesTheOuterCells) {
  MaterialRegion skin;
  skin.region.depth_m = {0.0, 0.0015};
  skin.material = named("skin", 1e5, 0.6);
  const LatticeMaterials materials = made_of({skin});
  int inner = 0;
  const LatticeMesh mesh = bar();
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      for (int k = 0; k < 10; ++k) {
        const bool is_inner = i > 0 && j > 0 && k > 0 && i < 4 && j < 4 && k < 9;
        inner += is_inner;
        EXPECT_EQ(materials.of(mesh.cell_index(i, j, k)).name, is_inner ? "own" : "skin") << i << j << k;
      }
    }
  }
  EXPECT_EQ(inner, 72);
}

TEST(LatticeMaterials, LaterRegionsWin) {
  MaterialRegion half, quarter, rough;
  half.region.along = {0.5, 1.0};
  half.material = named("half", 1e5, 0.4);
  quarter.region.along = {0.75, 1.0};
  quarter.material = named("quarter", 1e4, 0.5);
  rough.region.along = {0.9, 1.0};
  rough.friction = 0.9;
  const LatticeMaterials materials = made_of({half, quarter, rough});
  const LatticeMesh mesh = bar();
  const char* const expected[] = {"own",  "own",  "own",     "own",     "own",
                                  "half", "half", "quarter", "quarter", "quarter"};
  for (int k = 0; k < 10; ++k) EXPECT_EQ(materials.of(mesh.cell_index(2, 2, k)).name, expected[k]) << k;
  const double frictions[] = {0.2, 0.2, 0.2, 0.2, 0.2, 0.4, 0.4, 0.4, 0.5, 0.9, 0.9};
  for (int k = 0; k < 11; ++k) EXPECT_EQ(materials.friction(mesh.index(0, 2, k)), frictions[k]) << k;
}

TEST(LatticeMaterials, AFrictionWithAMaterialIsTheRegions) {
  MaterialRegion region;
  region.region.along = {0.5, 1.0};
  region.material = named("half", 1e5, 0.4);
  region.friction = 0.8;
  const LatticeMaterials materials = made_of({region});
  EXPECT_EQ(materials.friction(bar().index(0, 0, 10)), 0.8);
  EXPECT_EQ(materials.friction(bar().index(0, 0, 0)), 0.2);
}

TEST(LatticeMaterials, TheRestOfABodyMayChange) {
  MaterialRegion region;
  region.region.along = {0.5, 1.0};
  region.material = named("half", 1e5, 0.4);
  LatticeMaterials materials = made_of({region});
  materials.set_own(named("other", 3e6, 0.7));
  EXPECT_EQ(materials.of(bar().cell_index(0, 0, 0)).name, "other");
  EXPECT_EQ(materials.of(bar().cell_index(0, 0, 9)).name, "half");
  EXPECT_EQ(materials.friction(bar().index(0, 0, 0)), 0.7);
  EXPECT_EQ(materials.friction(bar().index(0, 0, 10)), 0.4);
}

TEST(LatticeMaterials, WrongRegionsAreRefusedInALine) {
  const auto refusal = [](const MaterialRegion& region) {
    MaterialRegion first;
    first.friction = 0.1;
    const Result<LatticeMaterials> made =
        lattice_materials(bar(), named("own", 1e6, 0.2), std::vector<MaterialRegion>{first, region});
    return Refusal(made);
  };
  MaterialRegion region;
  EXPECT_EQ(refusal(region), Refusal(ErrorCode::missing));
  region.friction = -0.1;
  EXPECT_EQ(refusal(region), Refusal(ErrorCode::out_of_range, "friction"));
  region.friction = std::nan("");
  EXPECT_NE(refusal(region).message.find("regions[1].friction"), std::string::npos);
  region.friction = 0.5;
  region.region.along = {0.7, 0.2};
  EXPECT_EQ(refusal(region).message, "regions[1].along is [0.7, 0.2], must run from the lower to the higher");
  region.region = {};
  region.region.depth_m = {0.001, 0.003};
  EXPECT_EQ(refusal(region), Refusal(ErrorCode::too_few, "friction"));
  region.material = named("skin", 1e6, 0.0);
  region.friction.reset();
  region.region.depth_m = {0.0, 0.0005};
  EXPECT_EQ(refusal(region), Refusal(ErrorCode::too_few));
  region.region = {};
  region.material->density_kg_per_m3 = 0.0;
  EXPECT_EQ(refusal(region).message,
            "regions[1].material skin: density_kg_per_m3 is 0, must be from 1 to 30000");
  const std::vector<MaterialRegion> many(17, MaterialRegion{{}, std::nullopt, 0.5});
  EXPECT_EQ(Refusal(lattice_materials(bar(), named("own", 1e6, 0.2), many)),
            Refusal(ErrorCode::out_of_range, "regions"));
}

// The spring solver advances either a whole body or no part of it. If one material of a body needs that
// solver, every other material of the body must suit it, too.
TEST(LatticeMaterials, WhatSpringsMustStepIsFitForSprings) {
  Material clay = named("clay", 1e5, 0.0), cork = named("cork", 1e6, 0.0);
  clay.plastic = true;
  cork.poissons_ratio = 0.05;
  LatticeMaterials materials(clay);
  EXPECT_TRUE(check_materials(materials).ok());
  materials.materials.push_back(cork);
  EXPECT_EQ(Refusal(check_materials(materials)), Refusal(ErrorCode::inconsistent, "poissons_ratio"));
  clay.plastic = false;
  materials.set_own(clay);
  EXPECT_TRUE(check_materials(materials).ok());
}

}  // namespace
}  // namespace spoonbill
