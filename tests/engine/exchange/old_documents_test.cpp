// Tests that documents of versions 1 and 2 can be read. Their former fields are converted to the current
// constants, which apply in real time.
#include "engine/exchange/old_documents.h"

#include <gtest/gtest.h>

#include <functional>

#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

const std::filesystem::path old_files = SPOONBILL_DOCUMENTS;

Json old_json(const char* name) {
  return parse_json(content_of(old_files / name), name).value();
}

// Returns the error of reading the document of version 2 to which `change` was applied.
Refusal refusal_of_old(const std::function<void(Json&)>& change) {
  Json json = old_json("version-2.json");
  change(json);
  return Refusal(document_from_json(json, "old.json"));
}

TEST(OldDocuments, AreReadWithTheirConstantsInRealTime) {
  Json json = old_json("version-2.json");
  json["tool"]["iterations"] = 4;
  json["sculpting"]["damping_per_s"] = 3;
  json["body"]["material"]["damping_ratio"] = 0.3;
  json["body"]["material"]["flow_rate_per_s"] = 40;
  const auto read = document_from_json(json, "old.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Scene& scene = read->scene;
  EXPECT_EQ(scene.tool.substeps, 4);
  EXPECT_EQ(scene.sculpting.drag_per_s, 12.0);
  EXPECT_FALSE(scene.sculpting.real_time);
  EXPECT_DOUBLE_EQ(scene.bodies[0].material.damping_time_s, 1e-4);
  EXPECT_EQ(scene.bodies[0].material.flow_rate_per_s, 160.0);
}

TEST(OldDocuments, ConvertEveryMaterial) {
  const auto converted = convert_old_document(old_json("version-2.json"), "old.json");
  ASSERT_TRUE(converted.ok()) << converted.error().message;
  const std::string text = json_to_line(converted.value());
  for (const char* name : {"damping_ratio", "loss_factor", "damping_per_s", "iterations"}) {
    EXPECT_EQ(text.find(name), std::string::npos) << name;
  }
}

TEST(OldDocuments, AreWrittenInTheCurrentVersion) {
  for (const char* name : {"version-1.json", "version-2.json"}) {
    TemporaryFolder folder;
    const auto file = folder.write("old.json", content_of(old_files / name));
    const auto read = read_document(file);
    ASSERT_TRUE(read.ok()) << read.error().message;
    ASSERT_TRUE(write_document(read.value(), file).ok());
    Json expected = convert_old_document(old_json(name), name).value();
    expected["spoonbill_document"] = document_version;
    EXPECT_EQ(content_of(file), json_to_page(expected)) << name;
    EXPECT_EQ(content_of(folder.path() / "old.json.bak"), content_of(old_files / name));
  }
}

TEST(OldDocuments, TakeALossFactorForTwiceTheDampingRatio) {
  Json json = old_json("version-2.json");
  Json& material = json["body"]["material"];
  material.erase("damping_ratio");
  material["loss_factor"] = 0.36;
  const auto read = document_from_json(json, "old.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_DOUBLE_EQ(read->scene.bodies[0].material.damping_time_s, 4e-5);
  EXPECT_EQ(refusal_of_old([](Json& j) { j["body"]["material"]["loss_factor"] = 0.1; }),
            Refusal(ErrorCode::duplicate, "body.material.loss_factor"));
}

TEST(OldDocuments, NameTheFormerFieldAndItsRange) {
  EXPECT_EQ(refusal_of_old([](Json& j) { j["tool"]["iterations"] = 9; }).message,
            "old.json: tool.iterations is 9, must be from 1 to 8");
  EXPECT_EQ(refusal_of_old([](Json& j) { j["sculpting"]["damping_per_s"] = 1001; }).message,
            "old.json: sculpting.damping_per_s is 1001, must be from 0 to 1000");
  EXPECT_EQ(refusal_of_old([](Json& j) { j["other_bodies"][0]["material"]["damping_ratio"] = 2.5; }).message,
            "old.json: other_bodies[0].material.damping_ratio is 2.5, must be from 0 to 2");
  EXPECT_EQ(refusal_of_old([](Json& j) { j["body"]["material"]["flow_rate_per_s"] = 1500; }).message,
            "old.json: body.material.flow_rate_per_s is 1500, must be from 0 to 1000");
  EXPECT_EQ(refusal_of_old([](Json& j) { j["body"]["material"].erase("damping_ratio"); }),
            Refusal(ErrorCode::missing, "body.material.damping_ratio"));
  EXPECT_EQ(refusal_of_old([](Json& j) { j["tool"].erase("iterations"); }),
            Refusal(ErrorCode::missing, "tool.iterations"));
}

TEST(OldDocuments, HaveNoCurrentFields) {
  EXPECT_EQ(refusal_of_old([](Json& j) { j["tool"]["substeps"] = 6; }),
            Refusal(ErrorCode::unknown, "tool.substeps"));
  EXPECT_EQ(refusal_of_old([](Json& j) { j["sculpting"]["real_time"] = true; }),
            Refusal(ErrorCode::unknown, "sculpting.real_time"));
  EXPECT_EQ(refusal_of_old([](Json& j) { j["sculpting"]["step_division"] = 2; }),
            Refusal(ErrorCode::unknown, "sculpting.step_division"));
  Json current = document_to_json(sample_document());
  current["body"]["material"]["damping_ratio"] = 0.1;
  EXPECT_EQ(Refusal(document_from_json(current, "new.json")),
            Refusal(ErrorCode::unknown, "body.material.damping_ratio"));
}

TEST(OldDocuments, OfVersionOneHaveNoSolids) {
  Json json = old_json("version-1.json");
  json["body"]["solid"] = "bracket";
  EXPECT_EQ(Refusal(document_from_json(json, "a.json")), Refusal(ErrorCode::unknown, "body.solid"));
  json["spoonbill_document"] = 2;
  EXPECT_TRUE(document_from_json(json, "a.json").ok());
}

TEST(OldDocuments, AMaterialFileIsReadAsOfSixIterations) {
  Json json = material_to_json(sample_document().scene.bodies[0].material);
  json.erase("damping_time_s");
  json["damping_ratio"] = 0.045;
  json["flow_rate_per_s"] = 50;
  TemporaryFolder folder;
  const auto read = read_material(folder.write("clay.json", json_to_page(json)));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_DOUBLE_EQ(read->damping_time_s, 1e-5);
  EXPECT_EQ(read->flow_rate_per_s, 300.0);
}

TEST(OldDocuments, CommandsTakeTheIterationsOfTheToolInForce) {
  OldCommands commands(3);
  const auto convert = [&](const char* text) {
    Json command = parse_json(text, "script").value();
    const Status status = commands.convert(command, "script");
    EXPECT_TRUE(status.ok());
    return json_to_line(command);
  };
  const char* sculpting = R"({"command":"set_sculpting","damping_per_s":2,"force_scale":1})";
  EXPECT_EQ(convert(sculpting), R"({"command":"set_sculpting","drag_per_s":6,"force_scale":1})");
  EXPECT_EQ(convert(R"({"command":"set_tool","radius_mm":8,"iterations":5})"),
            R"({"command":"set_tool","radius_mm":8,"substeps":5})");
  EXPECT_EQ(convert(sculpting), R"({"command":"set_sculpting","drag_per_s":10,"force_scale":1})");
  EXPECT_EQ(convert(R"({"command":"set_material","damping_ratio":0.375,"flow_rate_per_s":7})"),
            R"({"command":"set_material","damping_time_s":0.0001,"flow_rate_per_s":35})");
}

TEST(OldDocuments, LeaveCurrentCommandsAsTheyAre) {
  OldCommands commands;
  for (const char* text :
       {R"({"command":"set_tool","substeps":2})", R"({"command":"set_material","flow_rate_per_s":7})",
        R"({"command":"set_sculpting","drag_per_s":2})", R"({"command":"keep_shape"})",
        R"({"command":"set_camera","iterations":2})"}) {
    Json command = parse_json(text, "script").value();
    EXPECT_TRUE(commands.convert(command, "script").ok());
    EXPECT_EQ(json_to_line(command), text);
  }
}

TEST(OldDocuments, CommandsOutsideTheirFormerRangesAreErrors) {
  OldCommands commands;
  Json command{{"command", "set_tool"}, {"iterations", 0}};
  EXPECT_EQ(Refusal(commands.convert(command, "script")), Refusal(ErrorCode::out_of_range, "iterations"));
}

}  // namespace
}  // namespace spoonbill
