#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

const std::filesystem::path documents = SPOONBILL_DOCUMENTS;

Document trimmed_document() {
  return read_document(documents / "version-2.json").value();
}

std::string trim_refusal(const std::function<void(Json&)>& change) {
  Json json = document_to_json(trimmed_document());
  change(json["other_bodies"][0]["surface"]["trims"]);
  const auto read = document_from_json(json, "plate.json");
  return read.ok() ? "accepted" : read.error().message;
}

TEST(TrimJson, KeepsEveryLoopToTheBit) {
  Document document = trimmed_document();
  Body& plate = document.scene.bodies[1];
  ASSERT_EQ(plate.trims.size(), 2u);
  plate.trims[1].u[2] += 1.0 / 3.0e7;
  plate.trims[1].v[3] = -0.0;
  const auto json = parse_json(json_to_page(document_to_json(document)), "plate.json");
  const auto read = document_from_json(json.value(), "plate.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->scene.bodies[1].trims, plate.trims);
  EXPECT_TRUE(std::signbit(read->scene.bodies[1].trims[1].v[3]));
}

TEST(TrimJson, AnUntrimmedSurfaceHasNoSuchField) {
  EXPECT_FALSE(document_to_json(sample_document())["body"]["surface"].contains("trims"));
}

TEST(TrimJson, RefusesWhatIsNoLoop) {
  const std::string place = "plate.json: other_bodies[0].surface.trims";
  EXPECT_EQ(trim_refusal([](Json& trims) { trims[0]["control_points_uv"].erase(1); }),
            place + "[0].control_points_uv is a list of 4, must be a list of 5");
  EXPECT_EQ(trim_refusal([](Json& trims) {
              trims[0]["control_points_uv"][2] = {1, "2"};
            }),
            place + "[0].control_points_uv[2] must be 2 numbers from -10000000 to 10000000");
  EXPECT_EQ(trim_refusal([](Json& trims) { trims[1].erase("knots"); }), place + "[1].knots is missing");
  EXPECT_EQ(trim_refusal([](Json& trims) { trims[1]["colour"] = 1; }),
            place + "[1] has an unknown field \"colour\"; known: degree, periodic, knots, control_points_uv");
  EXPECT_EQ(trim_refusal([](Json& trims) {
              trims[0]["control_points_uv"][2] = {3.5, 0.95};
            }),
            place +
                "[0] a trim loop runs from u = 0.125 to 3.5, outside the surface's domain of 0 to 3; bring "
                "it inside");
  EXPECT_EQ(trim_refusal([](Json& trims) { trims.push_back(trims[0]); }),
            place + " are invalid: trim loop 0 coincides with another; remove one of them");
  EXPECT_EQ(trim_refusal([](Json& trims) {
              Json& points = trims[1]["control_points_uv"];
              std::reverse(points.begin(), points.end());
            }),
            place +
                " are invalid: trim loop 1 and trim loop 0 keep different parts; outer loops must run "
                "counter-clockwise and holes clockwise");
  EXPECT_EQ(trim_refusal([](Json& trims) { trims = 1; }), place + " is 1, must be a list of 0 to 1000");
}

// A document of version 1 is written as version 2 with only the version changed.
TEST(TrimJson, ADocumentOfVersionOneIsReadAndWrittenAsVersionTwo) {
  const auto read = read_document(documents / "version-1.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  std::string expected = content_of(documents / "version-1.json");
  const std::string field = "\"spoonbill_document\": 1";
  ASSERT_NE(expected.find(field), std::string::npos);
  expected.replace(expected.find(field), field.size(), "\"spoonbill_document\": 2");
  TemporaryFolder folder;
  const auto file = folder.write("old.json", content_of(documents / "version-1.json"));
  ASSERT_TRUE(write_document(read.value(), file).ok());
  EXPECT_EQ(content_of(file), expected);
  EXPECT_EQ(content_of(folder.path() / "old.json.bak"), content_of(documents / "version-1.json"));
}

TEST(TrimJson, ADocumentOfVersionTwoIsWrittenToTheSameBytes) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_document(trimmed_document(), folder.path() / "new.json").ok());
  EXPECT_EQ(content_of(folder.path() / "new.json"), content_of(documents / "version-2.json"));
}

TEST(TrimJson, VersionOneKnowsNoTrims) {
  Json json = document_to_json(trimmed_document());
  json["spoonbill_document"] = 1;
  const auto read = document_from_json(json, "plate.json");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(
      read.error().message,
      "plate.json: other_bodies[0].surface has an unknown field \"trims\"; known: u, v, control_points_mm");
}

}  // namespace
}  // namespace spoonbill
