// Tests regions of bodies in documents.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/exchange/document.h"
#include "engine/exchange/scene_json.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

Document document_with_regions() {
  Document document = sample_document();
  Body& body = document.scene.bodies[0];
  MaterialRegion skin, rough;
  skin.region = {{0.5, 1.0}, {0.9, 0.1}, {0.0, 0.002}};
  skin.material = body.material;
  skin.material->name = "silicone";
  skin.friction = 0.9;
  MaterialRegion core;
  core.region.depth_m.low = 0.003;
  core.material = body.material;
  rough.region.depth_m = {0.0, 1.0 / 3000.0};
  rough.friction = 0.1 + 0.2;
  body.regions = {skin, rough, core};
  return document;
}

TEST(RegionJson, ReadsBackToTheSameBits) {
  const Document document = document_with_regions();
  const Json json = document_to_json(document);
  const Result<Document> read = document_from_json(json, "sample.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  const std::vector<MaterialRegion>& regions = read->scene.bodies[0].regions;
  ASSERT_EQ(regions.size(), 3u);
  EXPECT_EQ(regions[2].region.depth_m.low, 0.003);
  EXPECT_TRUE(std::isinf(regions[2].region.depth_m.high));
  EXPECT_EQ(regions[0].region.along.low, 0.5);
  EXPECT_EQ(regions[0].region.around.low, 0.9);
  EXPECT_EQ(regions[0].region.around.high, 0.1);
  EXPECT_EQ(regions[0].region.depth_m.high, 0.002);
  EXPECT_EQ(regions[0].material->name, "silicone");
  EXPECT_EQ(regions[0].friction, 0.9);
  EXPECT_EQ(regions[1].region.along.low, 0.0);
  EXPECT_EQ(regions[1].region.along.high, 1.0);
  EXPECT_EQ(regions[1].region.depth_m.high, 1.0 / 3000.0);
  EXPECT_FALSE(regions[1].material.has_value());
  EXPECT_EQ(regions[1].friction, 0.1 + 0.2);
  EXPECT_EQ(json_to_page(document_to_json(read.value())), json_to_page(json));
}

TEST(RegionJson, WholeRangesAndNoRegionsAreLeftOut) {
  EXPECT_FALSE(document_to_json(sample_document())["body"].contains("regions"));
  const Json json = document_to_json(document_with_regions());
  EXPECT_FALSE(json["body"]["regions"][1]["region"].contains("along"));
  EXPECT_FALSE(json["body"]["regions"][1].contains("material"));
  EXPECT_EQ(json["body"]["regions"][0]["region"]["depth_mm"][1], 2.0);
}

TEST(RegionJson, WrongOnesAreRefusedByField) {
  const auto refusal = [](const auto& spoil) {
    Json json = document_to_json(document_with_regions());
    spoil(json["body"]["regions"]);
    return Refusal(document_from_json(json, "sample.json"));
  };
  const Refusal backwards = refusal([](Json& j) { j[1]["region"]["along"] = {0.7, 0.2}; });
  EXPECT_EQ(backwards, Refusal(ErrorCode::inconsistent, "body.regions[1].region"));
  EXPECT_NE(backwards.message.find("along is [0.7, 0.2]"), std::string::npos) << backwards;
  EXPECT_EQ(refusal([](Json& j) {
              j[1]["region"]["along"] = {0.0, 1.5};
            }),
            Refusal(ErrorCode::out_of_range, "body.regions[1].region.along"));
  EXPECT_EQ(refusal([](Json& j) { j[0]["region"]["around"] = {0.5}; }),
            Refusal(ErrorCode::too_few, "body.regions[0].region.around"));
  EXPECT_EQ(refusal([](Json& j) {
              j[0]["region"]["depth_mm"] = {-1, 2};
            }),
            Refusal(ErrorCode::out_of_range, "body.regions[0].region.depth_mm"));
  EXPECT_EQ(refusal([](Json& j) { j[1].erase("friction"); }), Refusal(ErrorCode::missing, "body.regions[1]"));
  EXPECT_EQ(refusal([](Json& j) { j[1]["friction"] = -1; }),
            Refusal(ErrorCode::out_of_range, "body.regions[1].friction"));
  EXPECT_EQ(refusal([](Json& j) { j[0]["material"]["poissons_ratio"] = 0.5; }),
            Refusal(ErrorCode::out_of_range, "body.regions[0].material.poissons_ratio"));
  EXPECT_EQ(refusal([](Json& j) { j[1]["colour"] = "red"; }),
            Refusal(ErrorCode::unknown, "body.regions[1].colour"));
  EXPECT_EQ(refusal([](Json& j) { j = 3; }), Refusal(ErrorCode::wrong_type, "body.regions"));
}

}  // namespace
}  // namespace spoonbill
