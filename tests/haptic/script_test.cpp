#include "haptic/script.h"

#include <gtest/gtest.h>

#include <random>

#include "haptic/device.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/damage.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

Result<Script> compile(const std::string& steps) {
  const std::string text =
      "{\"spoonbill_script\": 1, \"model\": \"../models/spoon.json\", \"steps\": [" + steps + "]}";
  const auto json = parse_json(text, "bend.json");
  if (!json.ok()) return json.error();
  return script_from_json(json.value(), "bend.json", "scripts");
}

Refusal script_refusal(const std::string& steps) {
  const auto script = compile(steps);
  return Refusal(script);
}

constexpr const char* start = "{\"start_mm\": [60, 40, 0]}";

TEST(Script, FindsTheModelFromItsFolder) {
  const Script script = compile(start).value();
  EXPECT_EQ(script.model_file, std::filesystem::path("scripts/../models/spoon.json"));
  EXPECT_EQ(script.tick_count(), 0u);
  EXPECT_EQ(script.target_at(5).pose.position_m, Vector3(0.06, 0.04, 0.0));
}

TEST(Script, MovesWithMinimumJerk) {
  const Script script = compile(std::string(start) + ",{\"move_to_mm\": [60, 0, 0], \"over_s\": 1}").value();
  ASSERT_EQ(script.tick_count(), 1000u);
  const auto height = [&](std::uint64_t tick) { return script.target_at(tick).pose.position_m.y(); };
  EXPECT_NEAR(height(499), 0.02, 1e-15);
  EXPECT_NEAR(height(249), 0.04 * (1.0 - (10.0 / 64 - 15.0 / 256 + 6.0 / 1024)), 1e-15);
  EXPECT_EQ(height(999), 0.0);
  EXPECT_EQ(height(5000), 0.0);
  EXPECT_LT(0.04 - height(0), 1e-9);
  double fastest = 0.0;
  for (std::uint64_t tick = 1; tick < 1000; ++tick)
    fastest = std::max(fastest, height(tick - 1) - height(tick));
  EXPECT_NEAR(fastest, 0.04 * 1.875e-3, 1e-8);
}

TEST(Script, ReadsCommandsWithFormerFields) {
  const Script script =
      compile(
          std::string(start) +
          ",{\"command\": \"set_tool\", \"kind\": \"sphere\", \"action\": \"push\", \"radius_mm\": 6, "
          "\"iterations\": 4},{\"command\": \"set_sculpting\", \"damping_per_s\": 2, \"gravity_m_per_s2\": "
          "[0, 0, 0], \"force_scale\": 1}")
          .value();
  ASSERT_EQ(script.commands.size(), 2u);
  EXPECT_EQ(script.commands[0].command["substeps"], 4);
  EXPECT_EQ(script.commands[1].command["drag_per_s"], 8);
  EXPECT_EQ(script_refusal(std::string(start) +
                           ",{\"command\": \"set_tool\", \"kind\": \"sphere\", \"action\": \"push\", "
                           "\"radius_mm\": 6, \"iterations\": 9}"),
            Refusal(ErrorCode::out_of_range, "iterations"));
}

TEST(Script, TurnsTheShortWay) {
  const Script script = compile(
                            "{\"start_mm\": [0,0,0], \"turn\": {\"axis\": [0,0,2], \"degrees\": 170}},"
                            "{\"turn_to\": {\"axis\": [0,0,1], \"degrees\": -170}, \"over_s\": 0.1}")
                            .value();
  EXPECT_NEAR(script.target_at(99).pose.orientation.angularDistance(
                  Quaternion(Eigen::AngleAxisd(-170.0 * 3.14159265358979 / 180.0, Vector3::UnitZ()))),
              0.0, 1e-7);
  for (std::uint64_t tick = 0; tick < 100; ++tick) {
    const Quaternion q = script.target_at(tick).pose.orientation;
    EXPECT_NEAR(q.norm(), 1.0, 1e-15);
    EXPECT_GT(std::abs(q.z()), 0.99) << "went the long way";
  }
}

TEST(Script, PutsCommandsAndGripsWhereTheyStand) {
  const Script script =
      compile(
          "{\"command\": \"look\", \"at_s\": 0, \"note\": \"first\"}," + std::string(start) +
          ",{\"hold_s\": 0.5},{\"grip\": true},{\"command\": \"remove_planes\"},"
          "{\"move_to_mm\": [0,0,0], \"over_s\": 0.25},{\"grip\": false},{\"at_s\": 2, \"note\": \"wait\"},"
          "{\"command\": \"keep_shape\"}")
          .value();
  EXPECT_EQ(script.tick_count(), 2000u);
  ASSERT_EQ(script.commands.size(), 3u);
  EXPECT_EQ(script.commands[0].tick, 0u);
  EXPECT_EQ(json_to_line(script.commands[0].command), "{\"command\":\"look\"}");
  EXPECT_EQ(script.commands[1].tick, 500u);
  EXPECT_EQ(script.commands[1].origin, "bend.json: steps[4]");
  EXPECT_EQ(script.commands[2].tick, 2000u);
  EXPECT_EQ(script.target_at(499).buttons, 0u);
  EXPECT_EQ(script.target_at(500).buttons, button_main);
  EXPECT_EQ(script.target_at(749).buttons, button_main);
  EXPECT_EQ(script.target_at(750).buttons, 0u);
}

TEST(Script, TakesTheHandsProperties) {
  const auto json = parse_json(
      "{\"spoonbill_script\":1,\"model\":\"m\",\"hand\":{\"mass_kg\":0.2,\"stiffness_n_per_m\":500,"
      "\"damping_n_s_per_m\":20},\"steps\":[{\"start_mm\":[0,0,0]}]}",
      "x");
  const auto script = script_from_json(json.value(), "x", "");
  ASSERT_TRUE(script.ok()) << script.error().message;
  EXPECT_EQ(script->hand.mass_kg, 0.2);
}

TEST(Script, NamesWhatIsWrong) {
  const std::string begin = std::string(start) + ",";
  EXPECT_EQ(script_refusal(""), Refusal(ErrorCode::too_few, "steps"));
  EXPECT_EQ(script_refusal("{\"hold_s\": 1}").message,
            "bend.json: steps[0] needs a start; put a step with start_mm before it");
  EXPECT_EQ(script_refusal("{\"grip\": true}"), Refusal(ErrorCode::out_of_range, "steps"));
  EXPECT_EQ(script_refusal(begin + start), Refusal(ErrorCode::out_of_range, "steps[1].start_mm"));
  EXPECT_EQ(script_refusal(begin + "{\"move_to_mm\": [0,0,0]}"),
            Refusal(ErrorCode::missing, "steps[1].over_s"));
  EXPECT_EQ(script_refusal(begin + "{\"move_to_mm\": [0,0,0], \"over_s\": 0}").message,
            "bend.json: steps[1].over_s is 0, must be from 0.001 to 600");
  EXPECT_EQ(script_refusal(begin + "{\"hold_s\": 0.0005}"),
            Refusal(ErrorCode::out_of_range, "steps[1].hold_s"));
  EXPECT_EQ(script_refusal(begin + "{\"hold_s\": 599.999},{\"hold_s\": 0.002}"),
            Refusal(ErrorCode::inconsistent, "steps[2]"));
  EXPECT_EQ(script_refusal(begin + "{\"hold_s\": 2},{\"at_s\": 1, \"grip\": true}"),
            Refusal(ErrorCode::out_of_range, "steps[2].at_s"));
  EXPECT_EQ(script_refusal(begin + "{\"move_to_mm\": [0,0,99999], \"over_s\": 1}"),
            Refusal(ErrorCode::out_of_range, "steps[1].move_to_mm[2]"));
  EXPECT_EQ(script_refusal(begin + "{\"note\": \"idle\"}"), Refusal(ErrorCode::inconsistent, "steps[1]"));
  EXPECT_EQ(script_refusal(begin + "{\"hold_s\": 1, \"over_s\": 2}"),
            Refusal(ErrorCode::unknown, "steps[1].over_s"));
  EXPECT_EQ(script_refusal(begin + "{\"command\": \"set_tool\", \"kind\": \"cube\"}"),
            Refusal(ErrorCode::unknown, "kind"));
  EXPECT_EQ(script_refusal(begin + "5"), Refusal(ErrorCode::wrong_type, "steps[1]"));
  EXPECT_EQ(script_refusal(begin + "{\"turn_to\": {\"axis\": [0,0,0], \"degrees\": 3}, \"over_s\": 1}"),
            Refusal(ErrorCode::degenerate, "steps[1].turn_to.axis"));
}

TEST(Script, SaysWhichModelIsMissing) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "bend.json",
      "{\"spoonbill_script\": 1, \"model\": \"none.json\", \"steps\": [{\"start_mm\": [0,0,0]}]}");
  const auto script = read_script(file);
  ASSERT_FALSE(script.ok());
  EXPECT_EQ(script.error().code, ErrorCode::unreadable);
  EXPECT_EQ(script.error().field, "model");
  EXPECT_EQ(script.error().message, file.string() + ": model: " + (folder.path() / "none.json").string() +
                                        " is not a file; give its path relative to the folder of the script");
  EXPECT_FALSE(read_script(folder.path()).ok());
  folder.write("none.json", "{}");
  EXPECT_TRUE(read_script(file).ok());
}

TEST(Script, AnyBytesChangedGiveAScriptOrOneLine) {
  const std::string text =
      R"({"spoonbill_script": 1, "model": "m", "hand": {"mass_kg": 0.1, "stiffness_n_per_m": 300,
    "damping_n_s_per_m": 10}, "steps": [{"start_mm": [60, 40, 0], "turn": {"axis": [0, 0, 1], "degrees": 90}},
    {"command": "place_plane", "point_mm": [20, 0, 0], "normal": [1, 0, 0]}, {"move_to_mm": [60, 6, 0], "over_s": 1.5},
    {"turn_to": {"axis": [0, 0, 1], "degrees": 0}, "over_s": 0.5}, {"grip": true}, {"hold_s": 0.5},
    {"at_s": 6, "grip": false}]})";
  std::mt19937_64 random(4);
  for (int i = random_cases(20'000, 200'000); i > 0; --i) {
    const auto json = parse_json(damaged(text, 0, random), "bend.json");
    const auto script =
        json.ok() ? script_from_json(json.value(), "bend.json", "") : Result<Script>(json.error());
    if (script.ok()) {
      for (const std::uint64_t tick : {0u, 1u, 500u, 5999u, 700000u}) {
        EXPECT_TRUE(script->target_at(tick).pose.position_m.allFinite());
      }
    } else {
      EXPECT_TRUE(script.error().message.starts_with("bend.json: ")) << script.error().message;
      EXPECT_EQ(script.error().message.find('\n'), std::string::npos) << script.error().message;
    }
  }
}

}  // namespace
}  // namespace spoonbill
