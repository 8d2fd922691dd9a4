#include "engine/exchange/document.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

Document through_text(const Document& document) {
  const auto json = parse_json(json_to_page(document_to_json(document)), "sample.json");
  EXPECT_TRUE(json.ok()) << json.error().message;
  auto read = document_from_json(json.value(), "sample.json");
  EXPECT_TRUE(read.ok()) << read.error().message;
  return read.value();
}

// Returns the error message for a sample document after `change`.
std::string refusal(const std::function<void(Json&)>& change) {
  Json json = document_to_json(sample_document());
  change(json);
  const auto read = document_from_json(json, "sample.json");
  return read.ok() ? "accepted" : read.error().message;
}

TEST(Document, KeepsEveryBitThroughText) {
  EXPECT_TRUE(same_bits(sample_document(), through_text(sample_document())));
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Document document = deformed_document(seed);
    EXPECT_TRUE(same_bits(document, through_text(document))) << "seed " << seed;
  }
}

TEST(Document, WritesTheSameBytesAgain) {
  const std::string written = json_to_page(document_to_json(deformed_document(7)));
  EXPECT_EQ(written, json_to_page(document_to_json(through_text(deformed_document(7)))));
}

TEST(Document, WritesNumbersAsAPersonWould) {
  const Json json = document_to_json(sample_document());
  EXPECT_EQ(json_to_line(json["tool"]), R"({"kind":"sphere","action":"push","radius_mm":8,"iterations":6})");
  EXPECT_EQ(json_to_line(json["body"]["lattice"]), R"({"node_budget":2000})");
  EXPECT_EQ(json_to_line(json["fixing_planes"]), R"([{"point_mm":[10,0,0],"normal":[1,0,0]}])");
  EXPECT_EQ(json_to_line(json["body"]["surface"]["control_points_mm"][1][3][2]), "5.196");
}

TEST(Document, NeedsNoPlanesAndNoView) {
  Json json = document_to_json(sample_document());
  json.erase("fixing_planes");
  json.erase("view");
  const auto read = document_from_json(json, "sample.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(read->scene.planes.empty());
}

TEST(Document, KeepsTheThicknessOfAShell) {
  Document document = sample_document();
  EXPECT_FALSE(document_to_json(document)["body"].contains("shell_thickness_mm")) << "a solid has none";
  document.scene.bodies[0].shell_thickness_m = 0.0015;
  const Json json = document_to_json(document);
  EXPECT_EQ(json_to_line(json["body"]["shell_thickness_mm"]), "1.5");
  EXPECT_EQ(through_text(document).scene.bodies[0].shell_thickness_m, 0.0015);
}

TEST(Document, RefusesWhatIsNoThickness) {
  const auto refused = [](const Json& thickness) {
    return refusal([&](Json& json) { json["body"]["shell_thickness_mm"] = thickness; });
  };
  for (const Json& thickness : {Json(-2), Json(0), Json(1000), Json("thin"), Json(nullptr), Json::array()}) {
    const std::string message = refused(thickness);
    EXPECT_EQ(message.substr(0, 36), "sample.json: body.shell_thickness_mm") << thickness;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  // Only a tool that is a surface has a shell thickness.
  EXPECT_NE(refusal([](Json& json) { json["tool"]["shell_thickness_mm"] = 2; }).find("shell_thickness_mm"),
            std::string::npos);
}

TEST(Document, ScalesNormalsToUnitLength) {
  Json json = document_to_json(sample_document());
  json["fixing_planes"][0]["normal"] = {0, 3, 4};
  const auto read = document_from_json(json, "sample.json");
  ASSERT_TRUE(read.ok());
  EXPECT_DOUBLE_EQ(read->scene.planes[0].normal.y(), 0.6);
}

TEST(Document, RefusesOtherVersions) {
  EXPECT_EQ(
      refusal([](Json& j) { j["spoonbill_document"] = 3; }),
      "sample.json: spoonbill_document is 3, this program reads 1 to 2; the file is from a newer program, "
      "update this one");
  EXPECT_EQ(refusal([](Json& j) { j["spoonbill_document"] = 0; }),
            "sample.json: spoonbill_document is 0, this program reads 1 to 2; the file has no known version");
  EXPECT_EQ(
      refusal([](Json& j) { j["spoonbill_document"] = "1"; }),
      "sample.json: spoonbill_document is \"1\", this program reads 1 to 2; the file has no known version");
  EXPECT_EQ(refusal([](Json& j) { j = Json::array(); }), "sample.json: is a list of 0, must be an object");
}

TEST(Document, NamesUnknownAndMissingFields) {
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["colour"] = "red"; }),
            "sample.json: tool has an unknown field \"colour\"; known: kind, action, radius_mm, iterations");
  EXPECT_EQ(refusal([](Json& j) { j["tool"].erase("radius_mm"); }), "sample.json: tool.radius_mm is missing");
  EXPECT_EQ(refusal([](Json& j) { j.erase("body"); }), "sample.json: body is missing");
  EXPECT_EQ(
      refusal([](Json& j) { j["extra"] = 1; }),
      "sample.json: has an unknown field \"extra\"; known: spoonbill_document, name, body, other_bodies, "
      "fixing_planes, tool, "
      "sculpting, view");
}

// Removes each field in turn, at every depth: a document without a required field is refused, and the message
// names the field.
TEST(Document, NamesEveryMissingField) {
  const Json flat = document_to_json(sample_document()).flatten();
  for (const auto& item : flat.items()) {
    const Json::json_pointer pointer(item.key());
    const std::string field = pointer.back();
    // These fields are optional and 0 by default.
    if (field == "hardening" || field == "stiffening" || field == "friction") continue;
    if (item.key().starts_with("/view") || field.find_first_not_of("0123456789") == std::string::npos) {
      continue;
    }
    Json json = document_to_json(sample_document());
    json[pointer.parent_pointer()].erase(field);
    const auto read = document_from_json(json, "sample.json");
    ASSERT_FALSE(read.ok()) << item.key();
    const std::string& message = read.error().message;
    EXPECT_EQ(read.error().code, ErrorCode::missing) << item.key() << ": " << message;
    EXPECT_NE(message.find(field), std::string::npos) << item.key() << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(Document, NamesWrongTypes) {
  EXPECT_EQ(refusal([](Json& j) { j["name"] = 5; }), "sample.json: name is 5, must be a text in quotes");
  EXPECT_EQ(refusal([](Json& j) { j["name"] = "two\nlines"; }),
            "sample.json: name contains control characters, remove them");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["material"]["plastic"] = 1; }),
            "sample.json: body.material.plastic is 1, must be true or false");
  EXPECT_EQ(refusal([](Json& j) { j["tool"] = "sphere"; }),
            "sample.json: tool is \"sphere\", must be an object");
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["kind"] = "cube"; }),
            "sample.json: tool.kind is \"cube\", must be point or sphere or solid");
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["iterations"] = 2.5; }),
            "sample.json: tool.iterations is 2.5, must be a whole number");
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["radius_mm"] = "8 mm"; }),
            "sample.json: tool.radius_mm is \"8 mm\", must be a number");
  EXPECT_EQ(refusal([](Json& j) { j["view"] = 3; }), "sample.json: view is 3, must be an object");
}

TEST(Document, StatesRangesInTheUnitOfTheFile) {
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["radius_mm"] = 900; }),
            "sample.json: tool.radius_mm is 900, must be 0 to 500");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["material"]["poissons_ratio"] = 0.5; }),
            "sample.json: body.material.poissons_ratio is 0.5, must be 0 to 0.49");
  EXPECT_EQ(refusal([](Json& j) {
              j["fixing_planes"][0]["normal"] = {0, 0, 0};
            }),
            "sample.json: fixing_planes[0].normal is zero, must have a length");
  EXPECT_EQ(refusal([](Json& j) {
              j["body"]["lattice"] = {{"nodes", {64, 64, 64}}};
            }),
            "sample.json: body.lattice.nodes must have a product of at most 40000");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["lattice"] = Json::object(); }),
            "sample.json: body.lattice must have either nodes or node_budget");
  EXPECT_EQ(refusal([](Json& j) {
              j["sculpting"]["gravity_m_per_s2"] = {90, 90, 0};
            }),
            "sample.json: sculpting.gravity_m_per_s2 must be no longer than 100");
}

TEST(Document, RefusesWrongMaterialsWithTheRange) {
  const auto with = [](const char* field, const Json& value) {
    return refusal([&](Json& j) { j["body"]["material"][field] = value; });
  };
  EXPECT_EQ(with("youngs_modulus_pa", -2e5),
            "sample.json: body.material.youngs_modulus_pa is -200000.0, must be 1 to 1e+12");
  EXPECT_EQ(with("youngs_modulus_pa", "200 kPa"),
            "sample.json: body.material.youngs_modulus_pa is \"200 kPa\", must be a number");
  EXPECT_EQ(with("youngs_modulus_pa", nullptr),  // JSON represents a number that is not finite as null
            "sample.json: body.material.youngs_modulus_pa is null, must be a number");
  EXPECT_EQ(with("density_kg_per_m3", 0),
            "sample.json: body.material.density_kg_per_m3 is 0, must be 1 to 30000");
  EXPECT_EQ(with("density_kg_per_m3", 1e300),
            "sample.json: body.material.density_kg_per_m3 is 1e+300, must be 1 to 30000");
  EXPECT_NE(with("youngs_modulus_kpa", 200).find("unknown field \"youngs_modulus_kpa\""), std::string::npos);
  EXPECT_EQ(
      with("loss_factor", 0.1),
      "sample.json: body.material.loss_factor is another name for damping_ratio; leave one of them out");
}

TEST(Document, TakesALossFactorForADampingRatio) {
  Json json = document_to_json(sample_document());
  Json& material = json["body"]["material"];
  material.erase("damping_ratio");
  material["loss_factor"] = 0.3;
  const auto read = document_from_json(json, "sample.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_DOUBLE_EQ(read->scene.bodies[0].material.damping_ratio, 0.15);
}

TEST(Document, RefusesAbsurdSurfaces) {
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["v"]["degree"] = 12; }),
            "sample.json: body.surface.v.degree is 12, must be 1 to 9");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["u"]["knots"] = std::vector<int>(5000, 1); }),
            "sample.json: body.surface.u.knots is a list of 5000, must be a list of 3 to 210");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["control_points_mm"].erase(0); }),
            "sample.json: body.surface.control_points_mm is a list of 5, must be a list of 6");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["control_points_mm"][2][1][0] = 1e9; }),
            "sample.json: body.surface.control_points_mm[2][1] must be 3 numbers from -100000 to 100000");
}

TEST(Document, RefusesKnotsThatAreNearlyEqual) {
  Json json = document_to_json(sample_document());
  Json& knots = json["body"]["surface"]["v"]["knots"];
  knots[5] = knots[4].get<double>() + 1e-13;
  const auto read = document_from_json(json, "sample.json");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, ErrorCode::degenerate) << read.error().message;
  EXPECT_EQ(read.error().field, "body.surface.v.knots[5]");
}

}  // namespace
}  // namespace spoonbill
