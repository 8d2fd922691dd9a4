// Tests loads, supports and the ground in documents.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"

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

std::string load_refusal(const std::function<void(Json&)>& spoil) {
  Json json = document_to_json(loaded_document());
  spoil(json);
  const auto read = document_from_json(json, "sample.json");
  return read.ok() ? "" : read.error().message;
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
  EXPECT_EQ(load(0, "kind", "weight"),
            "sample.json: body.loads[0].kind is \"weight\", must be pressure or force or point");
  EXPECT_NE(load(0, "pressure_pa", 2e9).find("pressure_pa is 2"), std::string::npos);
  EXPECT_NE(load(0, "pressure_pa", 2e9).find("must be -1e+09 to 1e+09"), std::string::npos);
  EXPECT_EQ(load(0, "pressure_pa", nullptr),
            "sample.json: body.loads[0].pressure_pa is null, must be a number");
  EXPECT_EQ(load(0, "pressure_kpa", 2).substr(0, 62),
            "sample.json: body.loads[0] has an unknown field \"pressure_kpa\"");
  EXPECT_EQ(load(1, "force_n", {8e5, 8e5, 0}),
            "sample.json: body.loads[1].force_n must be no longer than 1e+06");
  EXPECT_EQ(load(1, "force_n", {1, 2}),
            "sample.json: body.loads[1].force_n is a list of 2, must be a list of 3 numbers");
  EXPECT_EQ(load(1, "shared_by", "weight"),
            "sample.json: body.loads[1].shared_by is \"weight\", must be surface or volume");
  EXPECT_EQ(load(3, "u", 99).substr(0, 34), "sample.json: body.loads[3].u is 99");
}

TEST(LoadJson, NamesWhatIsWrongWithARegion) {
  const auto region = [](const char* field, const Json& value) {
    return load_refusal([&](Json& j) { j["body"]["supports"][0]["region"][field] = value; });
  };
  EXPECT_EQ(region("along", {0.5, 1.5}),
            "sample.json: body.supports[0].region.along is a list of 2, must be two numbers from 0 to 1");
  EXPECT_EQ(region("along", {0.5, "a"}),
            "sample.json: body.supports[0].region.along is a list of 2, must be two numbers from 0 to 1");
  EXPECT_EQ(region("around", {0.5}),
            "sample.json: body.supports[0].region.around is a list of 1, must be a list of 2");
  EXPECT_EQ(
      region("along", {0.5, 0.2}),
      "sample.json: body.supports[0].region along is [0.5, 0.2], must run from the lower to the higher");
  EXPECT_EQ(
      region("depth_mm", {-1}),
      "sample.json: body.supports[0].region.depth_mm is a list of 1, must be one or two numbers from 0 to "
      "1000");
  EXPECT_EQ(
      region("depth", 2),
      "sample.json: body.supports[0].region has an unknown field \"depth\"; known: along, around, depth_mm");
}

TEST(LoadJson, NamesWhatIsWrongWithAMotionOrTheGround) {
  const auto motion = [](const char* field, const Json& value) {
    return load_refusal([&](Json& j) { j["body"]["supports"][1]["motion"][field] = value; });
  };
  EXPECT_EQ(motion("kind", "jump"),
            "sample.json: body.supports[1].motion.kind is \"jump\", must be ramp or oscillation");
  EXPECT_EQ(motion("duration_s", 0),
            "sample.json: body.supports[1].motion.duration_s is 0, must be 0.01 to 3600");
  EXPECT_EQ(motion("way_mm", {900, 900, 0}),
            "sample.json: body.supports[1].motion.way_mm must be no longer than 1000");
  const std::string too_fast = load_refusal([](Json& j) {
    j["body"]["supports"][1]["motion"]["way_mm"] = {900, 0, 0};
    j["body"]["supports"][1]["motion"]["duration_s"] = 0.01;
  });
  EXPECT_EQ(too_fast.substr(0, 45), "sample.json: body.supports[1] motion reaches ");
  EXPECT_NE(too_fast.find("m/s, must stay below 5; shorten the displacement or allow more time"),
            std::string::npos);
  EXPECT_EQ(load_refusal([](Json& j) { j["ground"]["friction"] = -0.1; }),
            "sample.json: ground.friction is -0.1, must be 0 to 5");
  EXPECT_EQ(load_refusal([](Json& j) { j["ground"].erase("normal"); }),
            "sample.json: ground.normal is missing");
  EXPECT_EQ(load_refusal([](Json& j) { j["body"]["loads"] = std::vector<int>(65, 1); }),
            "sample.json: body.loads is a list of 65, must be a list of 0 to 64");
}

}  // namespace
}  // namespace spoonbill
