// Tests loads, supports and the ground in documents.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

Document loaded_document() {
  Document document = sample_document();
  Body& body = document.scene.bodies[0];
  const double inf = std::numeric_limits<double>::infinity();
  body.loads = {
      PressureLoad{{{0.5, 1.0}, {0.9, 0.1}, {0.0, 0.002}}, -150.5},
      ForceLoad{{{0.9, 1.0}}, Vector3(0, -2, 0.25), ForceDistribution::volume},
      ForceLoad{{{0.0, 1.0}, {0.0, 1.0}, {0.0013, inf}}, Vector3(1, 0, 0), ForceDistribution::surface},
      PointLoad{0.1, 0.2, Vector3(0, 0, 1.0 / 3.0)}};
  body.supports = {{{{0.0, 0.1}}, {}},
                   {{{0.9, 1.0}}, SupportMotion{MotionKind::ramp, Vector3(0.0, 0.0052, 0.0), 2.5}},
                   {{{0.5, 0.6}}, SupportMotion{MotionKind::oscillation, Vector3(0.001, 0, 0), 1.0, 12.5}}};
  document.scene.ground = Ground{Vector3(0, -0.012, 0), Vector3(0, 0.6, 0.8), 0.35};
  return document;
}

Refusal load_refusal(const std::function<void(Json&)>& spoil) {
  Json json = document_to_json(loaded_document());
  spoil(json);
  const auto read = document_from_json(json, "sample.json");
  return Refusal(read);
}

TEST(LoadJson, WritesWhatAPersonWould) {
  const Json json = document_to_json(loaded_document());
  const Json& loads = json["body"]["loads"];
  EXPECT_EQ(json_to_line(loads[0]),
            R"({"kind":"pressure","region":{"along":[0.5,1],"around":[0.9,0.1],"depth_mm":[0,2]},)"
            R"("pressure_pa":-150.5})");
  EXPECT_EQ(json_to_line(loads[1]),
            R"({"kind":"force","region":{"along":[0.9,1]},"force_n":[0,-2,0.25],"shared_by":"volume"})");
  EXPECT_EQ(json_to_line(loads[2]["region"]), R"({"depth_mm":[1.3]})");
  const Json& supports = json["body"]["supports"];
  EXPECT_EQ(json_to_line(supports[0]), R"({"region":{"along":[0,0.1]}})");
  EXPECT_EQ(json_to_line(supports[1]["motion"]), R"({"kind":"ramp","way_mm":[0,5.2,0],"duration_s":2.5})");
  EXPECT_EQ(json_to_line(supports[2]["motion"]),
            R"({"kind":"oscillation","way_mm":[1,0,0],"frequency_hz":12.5})");
  EXPECT_EQ(json_to_line(json["ground"]), R"({"point_mm":[0,-12,0],"normal":[0,0.6,0.8],"friction":0.35})");
}

TEST(LoadJson, ReadsBackTheSameBits) {
  const Json json = document_to_json(loaded_document());
  const auto read = document_from_json(json, "sample.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(json_to_page(document_to_json(read.value())), json_to_page(json));
  const Body& body = read->scene.bodies[0];
  const Document document = loaded_document();
  const Body& was = document.scene.bodies[0];
  ASSERT_EQ(body.loads.size(), 4u);
  EXPECT_EQ(std::get<PointLoad>(body.loads[3]).force_n, std::get<PointLoad>(was.loads[3]).force_n);
  EXPECT_EQ(std::get<ForceLoad>(body.loads[2]).region.depth_m.high, std::numeric_limits<double>::infinity());
  EXPECT_EQ(body.supports[1].motion->displacement_m, was.supports[1].motion->displacement_m);
  EXPECT_FALSE(body.supports[0].motion);
  EXPECT_EQ(read->scene.ground->normal, Vector3(0, 0.6, 0.8));
}

TEST(LoadJson, ADocumentWithoutLoadsIsAsItWas) {
  const Json json = document_to_json(sample_document());
  for (const char* field : {"loads", "supports"}) EXPECT_FALSE(json["body"].contains(field));
  EXPECT_FALSE(json.contains("ground"));
}

TEST(LoadJson, NamesWhatIsWrong) {
  const auto load = [](std::size_t at, const char* field, const Json& value) {
    return load_refusal([&](Json& j) { j["body"]["loads"][at][field] = value; });
  };
  EXPECT_EQ(load(0, "kind", "weight"), Refusal(ErrorCode::unknown, "body.loads[0].kind"));
  EXPECT_EQ(load(0, "pressure_pa", 2e9), Refusal(ErrorCode::out_of_range, "body.loads[0].pressure_pa"));
  EXPECT_EQ(load(0, "pressure_pa", nullptr), Refusal(ErrorCode::wrong_type, "body.loads[0].pressure_pa"));
  EXPECT_EQ(load(0, "pressure_kpa", 2), Refusal(ErrorCode::unknown, "body.loads[0].pressure_kpa"));
  EXPECT_EQ(load(1, "force_n", {8e5, 8e5, 0}), Refusal(ErrorCode::out_of_range, "body.loads[1].force_n"));
  EXPECT_EQ(load(1, "force_n", {1, 2}), Refusal(ErrorCode::wrong_type, "body.loads[1].force_n"));
  EXPECT_EQ(load(1, "shared_by", "weight"), Refusal(ErrorCode::unknown, "body.loads[1].shared_by"));
  EXPECT_EQ(load(3, "u", 99), Refusal(ErrorCode::out_of_range, "body.loads[3].u"));
}

TEST(LoadJson, NamesWhatIsWrongWithARegion) {
  const auto region = [](const char* field, const Json& value) {
    return load_refusal([&](Json& j) { j["body"]["supports"][0]["region"][field] = value; });
  };
  EXPECT_EQ(region("along", {0.5, 1.5}), Refusal(ErrorCode::out_of_range, "body.supports[0].region.along"));
  EXPECT_EQ(region("along", {0.5, "a"}), Refusal(ErrorCode::out_of_range, "body.supports[0].region.along"));
  EXPECT_EQ(region("around", {0.5}), Refusal(ErrorCode::too_few, "body.supports[0].region.around"));
  EXPECT_EQ(region("along", {0.5, 0.2}), Refusal(ErrorCode::inconsistent, "body.supports[0].region"));
  EXPECT_EQ(
      region("depth_mm", {-1}).message,
      "sample.json: body.supports[0].region.depth_mm is a list of 1, must be one or two numbers from 0 to "
      "1000");
  EXPECT_EQ(region("depth", 2), Refusal(ErrorCode::unknown, "body.supports[0].region.depth"));
}

TEST(LoadJson, NamesWhatIsWrongWithAMotionOrTheGround) {
  const auto motion = [](const char* field, const Json& value) {
    return load_refusal([&](Json& j) { j["body"]["supports"][1]["motion"][field] = value; });
  };
  EXPECT_EQ(motion("kind", "jump"), Refusal(ErrorCode::unknown, "body.supports[1].motion.kind"));
  EXPECT_EQ(motion("duration_s", 0), Refusal(ErrorCode::out_of_range, "body.supports[1].motion.duration_s"));
  EXPECT_EQ(motion("way_mm", {900, 900, 0}),
            Refusal(ErrorCode::out_of_range, "body.supports[1].motion.way_mm"));
  const Refusal too_fast = load_refusal([](Json& j) {
    j["body"]["supports"][1]["motion"]["way_mm"] = {900, 0, 0};
    j["body"]["supports"][1]["motion"]["duration_s"] = 0.01;
  });
  EXPECT_EQ(too_fast.field, "body.supports[1]");
  EXPECT_EQ(too_fast.code, ErrorCode::out_of_range);
  EXPECT_NE(too_fast.message.find("motion reaches "), std::string::npos) << too_fast;
  EXPECT_EQ(load_refusal([](Json& j) { j["ground"]["friction"] = -0.1; }),
            Refusal(ErrorCode::out_of_range, "ground.friction"));
  EXPECT_EQ(load_refusal([](Json& j) { j["ground"].erase("normal"); }),
            Refusal(ErrorCode::missing, "ground.normal"));
  EXPECT_EQ(load_refusal([](Json& j) { j["body"]["loads"] = std::vector<int>(65, 1); }),
            Refusal(ErrorCode::too_many, "body.loads"));
}

}  // namespace
}  // namespace spoonbill
