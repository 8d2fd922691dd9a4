#include "engine/exchange/document.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

Document through_text(const Document& document) {
  const auto json = parse_json(json_to_page(document_to_json(document)), "sample.json");
  EXPECT_TRUE(json.ok()) << json.error().message;
  auto read = document_from_json(json.value(), "sample.json");
  EXPECT_TRUE(read.ok()) << read.error().message;
  return read.value();
}

// Returns the error of reading a sample document to which `change` was applied.
Refusal refusal(const std::function<void(Json&)>& change) {
  Json json = document_to_json(sample_document());
  change(json);
  const auto read = document_from_json(json, "sample.json");
  return Refusal(read);
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
  EXPECT_EQ(json_to_line(json["tool"]), R"({"kind":"sphere","action":"push","radius_mm":8,"substeps":6})");
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

TEST(Document, KeepsTheKindOfABodyAndTheTrial) {
  Document document = sample_document();
  Body spoon = document.scene.bodies[0];
  spoon.name = "spoon";
  spoon.kind = BodyKind::fixed;
  spoon.regions.clear();
  spoon.loads.clear();
  spoon.supports.clear();
  document.scene.bodies[0].name = "jelly";
  document.scene.bodies.push_back(spoon);
  document.scene.trial = TrialPlan{"jelly", 0.02, "spoon", {0.001, 0.0, 0.0}, Vector3::UnitY(), -7.5, 12.0};
  const Json json = document_to_json(document);
  EXPECT_FALSE(json["body"].contains("kind"));
  EXPECT_FALSE(json["other_bodies"][0].contains("lattice"));
  const auto read = document_from_json(json, "text");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->scene.bodies[0].kind, BodyKind::deformable);
  EXPECT_EQ(read->scene.bodies[1].kind, BodyKind::fixed);
  EXPECT_EQ(document_to_json(read.value()), json);

  Json loaded = json;
  loaded["other_bodies"][0]["supports"] = Json::array({{{"region", Json::object()}}});
  EXPECT_EQ(Refusal(document_from_json(loaded, "text")),
            Refusal(ErrorCode::inconsistent, "other_bodies[0].supports"));
  Json unnamed = json;
  unnamed["trial"]["turned_body"] = "jelly";
  EXPECT_EQ(Refusal(document_from_json(unnamed, "text")), Refusal(ErrorCode::inconsistent, "turned_body"));
  Json fast = json;
  fast["trial"]["turn_speed_deg_per_s"] = 1000;
  EXPECT_EQ(Refusal(document_from_json(fast, "text")),
            Refusal(ErrorCode::out_of_range, "trial.turn_speed_deg_per_s"));
}

// Gives the first body a kind that has no regions, loads or supports.
Body& make_first_body(BodyKind kind, Document& document) {
  Body& body = document.scene.bodies[0];
  body.regions.clear();
  body.loads.clear();
  body.supports.clear();
  body.kind = kind;
  return body;
}

// The placement is applied when a document is read, and is not written again.
TEST(Document, PlacesABodyAndKeepsTheHandThatHoldsIt) {
  Document document = sample_document();
  Body& body = make_first_body(BodyKind::rigid, document);
  body.hand = HandSpring{120.0, 0.5};
  const Json json = document_to_json(document);
  const Document same = document_from_json(json, "text").value();
  EXPECT_EQ(same.scene.bodies[0].kind, BodyKind::rigid);
  ASSERT_TRUE(same.scene.bodies[0].hand);
  EXPECT_EQ(same.scene.bodies[0].hand->stiffness_n_per_m, 120.0);
  EXPECT_EQ(same.scene.bodies[0].hand->turn_stiffness_nm_per_rad, 0.5);

  document.scene.bodies[0].hand = HandSpring{};
  EXPECT_TRUE(document_from_json(document_to_json(document), "text").value().scene.bodies[0].hand);

  Json placed = json;
  placed["body"]["pose"] = {{"position_mm", {10, 0, 0}}, {"axis", {0, 0, 1}}, {"angle_deg", 90}};
  const auto read = document_from_json(placed, "text");
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Vector3 before = body.surface.net.point(1, 2), after = read->scene.bodies[0].surface.net.point(1, 2);
  EXPECT_LT((after - Vector3(0.01 - before.y(), before.x(), before.z())).norm(), 1e-12);
  EXPECT_FALSE(document_to_json(read.value())["body"].contains("pose"));

  Json skew = placed;
  skew["body"]["pose"]["axis"] = {0, 0, 0};
  EXPECT_FALSE(document_from_json(skew, "text").ok());
  Json loose = json;
  loose["body"]["hand"]["stiffness_n_per_m"] = 0;
  EXPECT_EQ(Refusal(document_from_json(loose, "text")),
            Refusal(ErrorCode::out_of_range, "body.hand.stiffness_n_per_m"));
  Json fixed = json;
  fixed["body"]["kind"] = "fixed";
  EXPECT_EQ(Refusal(document_from_json(fixed, "text")), Refusal(ErrorCode::inconsistent, "body.hand"));
}

TEST(Document, KeepsTheMotionOfABody) {
  Document document = sample_document();
  Body& body = make_first_body(BodyKind::fixed, document);
  body.motion = BodyMotion{
      {0.01, 0.0, 0.0},
      {{0.5, {0.0, 0.02, 0.0}, Vector3::UnitY(), 0.0}, {1.5, {0.0, 0.02, 0.01}, Vector3::UnitZ(), 45.0}}};
  const Json json = document_to_json(document);
  const auto read = document_from_json(json, "text");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(document_to_json(read.value()), json);
  ASSERT_TRUE(read->scene.bodies[0].motion);
  const Waypoint& last = read->scene.bodies[0].motion->waypoints.at(1);
  EXPECT_EQ(last.time_s, 1.5);
  EXPECT_EQ(last.moved_m, Vector3(0.0, 0.02, 0.01));
  EXPECT_EQ(last.axis, Vector3::UnitZ());
  EXPECT_EQ(last.angle_deg, 45.0);

  Json early = json;
  early["body"]["motion"]["waypoints"][1]["at_s"] = 0.5;
  EXPECT_EQ(Refusal(document_from_json(early, "text")), Refusal(ErrorCode::inconsistent, "body.motion"));
  Json none = json;
  none["body"]["motion"]["waypoints"] = Json::array();
  EXPECT_EQ(Refusal(document_from_json(none, "text")), Refusal(ErrorCode::too_few, "body.motion.waypoints"));
  Json free = json;
  free["body"]["kind"] = "rigid";
  EXPECT_EQ(Refusal(document_from_json(free, "text")), Refusal(ErrorCode::inconsistent, "body.motion"));
}

TEST(Document, KeepsTheRimOfABody) {
  Document document = sample_document();
  Body& body = document.scene.bodies[0];
  const Vector2 corner(body.surface.u.domain_start(), body.surface.v.domain_end());
  body.rim = {corner, Vector2(body.surface.u.domain_end(), corner.y()),
              Vector2(corner.x(), 0.5 * corner.y())};
  const Json json = document_to_json(document);
  EXPECT_EQ(document_from_json(json, "text").value().scene.bodies[0].rim, body.rim);
  for (const Json& wrong : {Json::parse("[[0, 0], [0, 0]]"), Json::parse("[[0, 0], [0, 0], [0]]"),
                            Json::parse("[[0, 0], [0, 0], [0, 1e6]]"), Json::parse("{}")}) {
    Json refused = json;
    refused["body"]["rim_uv"] = wrong;
    const auto read = document_from_json(refused, "text");
    ASSERT_FALSE(read.ok()) << wrong;
    EXPECT_EQ(read.error().field.rfind("body.rim_uv", 0), 0u) << read.error().field;
  }
}

TEST(Document, KeepsTheCellsOfALattice) {
  Document document = sample_document();
  EXPECT_FALSE(document_to_json(document)["body"]["lattice"].contains("cells"))
      << "bent cells are the default";
  document.scene.bodies[0].lattice.cells = LatticeCells::box;
  EXPECT_EQ(through_text(document).scene.bodies[0].lattice.cells, LatticeCells::box);
  EXPECT_EQ(refusal([](Json& json) { json["body"]["lattice"]["cells"] = "round"; }).field,
            "body.lattice.cells");
}

TEST(Document, RefusesWhatIsNoThickness) {
  const auto refused = [](const Json& thickness) {
    return refusal([&](Json& json) { json["body"]["shell_thickness_mm"] = thickness; });
  };
  for (const Json& thickness : {Json(-2), Json(0), Json(1000), Json("thin"), Json(nullptr), Json::array()}) {
    const Refusal refusal = refused(thickness);
    EXPECT_EQ(refusal.code, thickness.is_number() ? ErrorCode::out_of_range : ErrorCode::wrong_type)
        << refusal;
    EXPECT_EQ(refusal.field, "body.shell_thickness_mm") << thickness;
    EXPECT_EQ(refusal.message.find('\n'), std::string::npos);
  }
  // Only a body has a shell thickness; a tool has none.
  EXPECT_EQ(refusal([](Json& json) { json["tool"]["shell_thickness_mm"] = 2; }),
            Refusal(ErrorCode::unknown, "tool.shell_thickness_mm"));
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
      refusal([](Json& j) { j["spoonbill_document"] = 4; }).message,
      "sample.json: spoonbill_document is 4, this program reads 1 to 3; the file is from a newer program, "
      "update this one");
  EXPECT_EQ(refusal([](Json& j) { j["spoonbill_document"] = 0; }).message,
            "sample.json: spoonbill_document is 0, this program reads 1 to 3; the file has no known version");
  EXPECT_EQ(
      refusal([](Json& j) { j["spoonbill_document"] = "1"; }).message,
      "sample.json: spoonbill_document is \"1\", this program reads 1 to 3; the file has no known version");
  EXPECT_EQ(refusal([](Json& j) { j = Json::array(); }), Refusal(ErrorCode::wrong_type));
}

TEST(Document, NamesUnknownAndMissingFields) {
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["colour"] = "red"; }).message,
            "sample.json: tool has an unknown field \"colour\"; known: kind, action, radius_mm, substeps");
  EXPECT_EQ(refusal([](Json& j) { j["tool"].erase("radius_mm"); }),
            Refusal(ErrorCode::missing, "tool.radius_mm"));
  EXPECT_EQ(refusal([](Json& j) { j.erase("body"); }), Refusal(ErrorCode::missing, "body"));
  EXPECT_EQ(
      refusal([](Json& j) { j["extra"] = 1; }).message,
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
    // These fields are optional; without them they are 0 or empty.
    if (field == "hardening" || field == "stiffening" || field == "friction" ||
        field == "yield_strength_pa" || field == "yield_source") {
      continue;
    }
    if (item.key().starts_with("/view") || field.find_first_not_of("0123456789") == std::string::npos) {
      continue;
    }
    Json json = document_to_json(sample_document());
    json[pointer.parent_pointer()].erase(field);
    const auto read = document_from_json(json, "sample.json");
    ASSERT_FALSE(read.ok()) << item.key();
    const std::string& message = read.error().message;
    EXPECT_EQ(read.error().code, ErrorCode::missing) << item.key() << ": " << message;
    // The lattice needs `nodes` or `node_budget`. Without node_budget, the error names the lattice.
    EXPECT_TRUE(read.error().field.ends_with(field == "node_budget" ? "lattice" : field))
        << item.key() << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(Document, NamesWrongTypes) {
  EXPECT_EQ(refusal([](Json& j) { j["name"] = 5; }), Refusal(ErrorCode::wrong_type, "name"));
  EXPECT_EQ(refusal([](Json& j) { j["name"] = "two\nlines"; }).message,
            "sample.json: name contains control characters; remove them");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["material"]["plastic"] = 1; }),
            Refusal(ErrorCode::wrong_type, "body.material.plastic"));
  EXPECT_EQ(refusal([](Json& j) { j["tool"] = "sphere"; }), Refusal(ErrorCode::wrong_type, "tool"));
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["kind"] = "cube"; }), Refusal(ErrorCode::unknown, "tool.kind"));
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["substeps"] = 2.5; }),
            Refusal(ErrorCode::out_of_range, "tool.substeps"));
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["radius_mm"] = "8 mm"; }),
            Refusal(ErrorCode::wrong_type, "tool.radius_mm"));
  EXPECT_EQ(refusal([](Json& j) { j["view"] = 3; }), Refusal(ErrorCode::wrong_type, "view"));
}

TEST(Document, StatesRangesInTheUnitOfTheFile) {
  EXPECT_EQ(refusal([](Json& j) { j["tool"]["radius_mm"] = 900; }).message,
            "sample.json: tool.radius_mm is 900, must be from 0 to 500");
  EXPECT_EQ(refusal([](Json& j) { j["body"]["material"]["poissons_ratio"] = 0.5; }),
            Refusal(ErrorCode::out_of_range, "body.material.poissons_ratio"));
  EXPECT_EQ(refusal([](Json& j) {
              j["fixing_planes"][0]["normal"] = {0, 0, 0};
            }),
            Refusal(ErrorCode::degenerate, "fixing_planes[0].normal"));
  EXPECT_EQ(refusal([](Json& j) {
              j["body"]["lattice"] = {{"nodes", {64, 64, 64}}};
            }),
            Refusal(ErrorCode::too_many, "body.lattice.nodes"));
  EXPECT_EQ(refusal([](Json& j) { j["body"]["lattice"] = Json::object(); }),
            Refusal(ErrorCode::missing, "body.lattice"));
  EXPECT_EQ(refusal([](Json& j) {
              j["sculpting"]["gravity_m_per_s2"] = {90, 90, 0};
            }),
            Refusal(ErrorCode::out_of_range, "sculpting.gravity_m_per_s2"));
}

TEST(Document, RefusesWrongMaterialsWithTheRange) {
  const auto with = [](const char* field, const Json& value) {
    return refusal([&](Json& j) { j["body"]["material"][field] = value; });
  };
  EXPECT_EQ(with("youngs_modulus_pa", -2e5),
            Refusal(ErrorCode::out_of_range, "body.material.youngs_modulus_pa"));
  EXPECT_EQ(with("youngs_modulus_pa", "200 kPa"),
            Refusal(ErrorCode::wrong_type, "body.material.youngs_modulus_pa"));
  EXPECT_EQ(with("youngs_modulus_pa", nullptr),  // JSON writes null for a number that is not finite
            Refusal(ErrorCode::wrong_type, "body.material.youngs_modulus_pa"));
  EXPECT_EQ(with("density_kg_per_m3", 0),
            Refusal(ErrorCode::out_of_range, "body.material.density_kg_per_m3"));
  EXPECT_EQ(with("density_kg_per_m3", 1e300),
            Refusal(ErrorCode::out_of_range, "body.material.density_kg_per_m3"));
  EXPECT_EQ(with("youngs_modulus_kpa", 200), Refusal(ErrorCode::unknown, "body.material.youngs_modulus_kpa"));
  EXPECT_EQ(with("damping_time_s", 0.006), Refusal(ErrorCode::out_of_range, "body.material.damping_time_s"));
}

TEST(Document, RefusesAbsurdSurfaces) {
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["v"]["degree"] = 12; }),
            Refusal(ErrorCode::out_of_range, "body.surface.v.degree"));
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["u"]["knots"] = std::vector<int>(5000, 1); }),
            Refusal(ErrorCode::too_many, "body.surface.u.knots"));
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["control_points_mm"].erase(0); }),
            Refusal(ErrorCode::too_few, "body.surface.control_points_mm"));
  EXPECT_EQ(refusal([](Json& j) { j["body"]["surface"]["control_points_mm"][2][1][0] = 1e9; }),
            Refusal(ErrorCode::out_of_range, "body.surface.control_points_mm[2][1]"));
}

TEST(Document, KeepsFourThousandControlPointsInADirection) {
  Document document = sample_document();
  document.scene.bodies[0].surface = wavy_sheet(4, 4000);
  EXPECT_TRUE(same_bits(document, through_text(document)));
  document.scene.bodies[0].surface = wavy_sheet(4, 4001);
  const auto wider = document_from_json(document_to_json(document), "sample.json");
  EXPECT_EQ(wider.error().code, ErrorCode::too_many) << wider.error().message;
}

TEST(Document, RefusesMoreThanAMillionControlPoints) {
  Document document = sample_document();
  for (Body& body : document.scene.bodies) body.surface = wavy_sheet(4, 4000);
  document.scene.bodies.resize(1, document.scene.bodies[0]);
  const std::size_t most = static_cast<std::size_t>(document_control_point_limit) / 16000;
  document.scene.bodies.resize(most, document.scene.bodies[0]);
  EXPECT_TRUE(document_from_json(document_to_json(document), "sample.json"));
  document.scene.bodies.push_back(document.scene.bodies[0]);
  EXPECT_EQ(document_from_json(document_to_json(document), "sample.json").error().code, ErrorCode::too_many);
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
