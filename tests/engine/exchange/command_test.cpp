#include <gtest/gtest.h>

#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

Refusal command_refusal(const char* text) {
  const auto command = command_from_json(parse_json(text, "text").value(), "bend.jsonl: line 4");
  return Refusal(command);
}

TEST(Command, ReadsWhatItWrites) {
  const Scene scene = deformed_document(3).scene;
  const Command commands[] = {
      PlacePlane{scene.planes.front()},
      RemovePlanes{},
      SetTool{scene.tool},
      SetMaterial{scene.bodies[0].material},
      SetSculpting{scene.sculpting},
      SetSymmetry{{true, Vector3(0.01, 0, 0), Vector3::UnitX()}},
      ResetProxy{},
      LiftTool{},
      KeepShape{},
      RefineKnots{1},
      TurnBody{1, Vector3(0.01, 0, 0), Vector3::UnitZ(), -12.5, 60.0},
      LowerBody{2, 0.02},
      MoveBody{1, {{0.01, 0.0, 0.0}, {{0.5, {0.02, 0.0, 0.0}, Vector3::UnitY(), 5.0}}}}};
  for (const Command& command : commands) {
    const Json json = command_to_json(command);
    EXPECT_TRUE(is_simulation_command(json)) << json_to_line(json);
    const auto read = command_from_json(json, "text");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->index(), command.index());
    EXPECT_EQ(command_to_json(read.value()), json);
  }
}

TEST(Command, KnowsItsNames) {
  EXPECT_FALSE(is_simulation_command(Json{{"command", "set_camera"}}));
  EXPECT_FALSE(is_simulation_command(Json{{"command", 4}}));
  EXPECT_FALSE(is_simulation_command(Json::object()));
  EXPECT_FALSE(is_simulation_command(Json(5)));
}

TEST(Command, NamesWhatIsWrong) {
  EXPECT_EQ(command_refusal("{\"command\": \"fly\"}").message,
            "bend.jsonl: line 4: command is \"fly\", must be one of place_plane, remove_planes, set_tool, "
            "set_material, set_sculpting, set_symmetry, reset_proxy, lift_tool, keep_shape, refine_knots, "
            "turn_body, lower_body, move_body");
  EXPECT_EQ(command_refusal("{}"), Refusal(ErrorCode::missing, "command"));
  EXPECT_EQ(command_refusal("{\"command\": 3}"), Refusal(ErrorCode::wrong_type, "command"));
  EXPECT_EQ(command_refusal("[]"), Refusal(ErrorCode::wrong_type));
  EXPECT_EQ(command_refusal("{\"command\": \"keep_shape\", \"now\": true}"),
            Refusal(ErrorCode::unknown, "now"));
  EXPECT_EQ(
      command_refusal("{\"command\": \"place_plane\", \"point_mm\": [1, 2, \"x\"], \"normal\": [1, 0, 0]}"),
      Refusal(ErrorCode::wrong_type, "point_mm[2]"));
}

}  // namespace
}  // namespace spoonbill
