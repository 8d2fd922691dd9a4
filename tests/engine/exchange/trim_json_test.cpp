#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

const std::filesystem::path documents = SPOONBILL_DOCUMENTS;

Document trimmed_document() {
  return read_document(documents / "version-3.json").value();
}

Refusal trim_refusal(const std::function<void(Json&)>& change) {
  Json json = document_to_json(trimmed_document());
  change(json["other_bodies"][0]["surface"]["trims"]);
  const auto read = document_from_json(json, "plate.json");
  return Refusal(read);
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
            Refusal(ErrorCode::too_few, "other_bodies[0].surface.trims[0].control_points_uv"));
  EXPECT_EQ(trim_refusal([](Json& trims) {
              trims[0]["control_points_uv"][2] = {1, "2"};
            }),
            Refusal(ErrorCode::out_of_range, "other_bodies[0].surface.trims[0].control_points_uv[2]"));
  EXPECT_EQ(trim_refusal([](Json& trims) { trims[1].erase("knots"); }),
            Refusal(ErrorCode::missing, "other_bodies[0].surface.trims[1].knots"));
  EXPECT_EQ(trim_refusal([](Json& trims) { trims[1]["colour"] = 1; }),
            Refusal(ErrorCode::unknown, "other_bodies[0].surface.trims[1].colour"));
  EXPECT_EQ(trim_refusal([](Json& trims) {
              trims[0]["control_points_uv"][2] = {3.5, 0.95};
            }).message,
            place +
                "[0] a trim loop runs from u = 0.125 to 3.5, outside the surface's domain of 0 to 3; bring "
                "it inside");
  EXPECT_EQ(trim_refusal([](Json& trims) { trims.push_back(trims[0]); }),
            Refusal(ErrorCode::duplicate, "other_bodies[0].surface.trims"));
  EXPECT_EQ(trim_refusal([](Json& trims) {
              Json& points = trims[1]["control_points_uv"];
              std::reverse(points.begin(), points.end());
            }),
            Refusal(ErrorCode::inconsistent, "other_bodies[0].surface.trims"));
  EXPECT_EQ(trim_refusal([](Json& trims) { trims = 1; }),
            Refusal(ErrorCode::wrong_type, "other_bodies[0].surface.trims"));
}

TEST(TrimJson, ADocumentIsWrittenToTheSameBytes) {
  TemporaryFolder folder;
  ASSERT_TRUE(write_document(trimmed_document(), folder.path() / "new.json").ok());
  EXPECT_EQ(content_of(folder.path() / "new.json"), content_of(documents / "version-3.json"));
}

TEST(TrimJson, VersionOneKnowsNoTrims) {
  Json json = parse_json(content_of(documents / "version-2.json"), "plate.json").value();
  json["spoonbill_document"] = 1;
  const auto read = document_from_json(json, "plate.json");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(Refusal(read), Refusal(ErrorCode::unknown, "other_bodies[0].surface.trims"));
}

}  // namespace
}  // namespace spoonbill
