#include "app/session/view_choice.h"

#include <gtest/gtest.h>

namespace spoonbill {
namespace {

Json parsed(const std::string& text) {
  return parse_json(text, "test").value();
}

TEST(ViewChoice, DefaultsShowTheWholeBody) {
  const auto view = view_from_json(Json::object(), "test");
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->shows_whole_body);
  EXPECT_TRUE(view->overlays.fixed_nodes);
  EXPECT_FALSE(view->overlays.lattice);
}

TEST(ViewChoice, ReadsCameraAndOverlays) {
  const auto view =
      view_from_json(parsed(R"({"camera": {"yaw_deg": 90, "target_mm": [10, 0, 0], "distance_mm": 400},
                 "overlays": {"lattice": true, "tool": false}, "see_through_body": true})"),
                     "test");
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->shows_whole_body);
  EXPECT_DOUBLE_EQ(view->camera.target_m.x(), 0.01);
  EXPECT_DOUBLE_EQ(view->camera.distance_m, 0.4);
  EXPECT_NEAR(view->camera.yaw_rad, 1.5707963, 1e-6);
  EXPECT_TRUE(view->overlays.lattice);
  EXPECT_FALSE(view->overlays.tool);
  EXPECT_TRUE(view->overlays.fixed_nodes);
  EXPECT_TRUE(view->see_through_body);
}

TEST(ViewChoice, TheGroundIsThatOfTheSceneFirst) {
  ViewChoice view;
  Framing framing{Box{Vector3(0, -0.01, 0), Vector3(1, 1, 1)}, std::nullopt, -0.02};
  const auto ground = [&] { return make_view_settings(view, framing, 640, 480, {}, 1.0).ground_y_m; };
  EXPECT_EQ(ground(), -0.02);
  view.ground_y_m = -0.04;
  EXPECT_EQ(ground(), -0.04);
  framing.scene_ground_y_m = 0.03;
  EXPECT_EQ(ground(), 0.03);
}

TEST(ViewChoice, CommandsChangeWhatTheyName) {
  ViewChoice choice;
  ASSERT_TRUE(
      apply_view_command(parsed(R"({"command": "set_overlays", "control_net": true})"), "test", choice));
  EXPECT_TRUE(choice.overlays.control_net);
  EXPECT_TRUE(choice.overlays.force);
  EXPECT_FALSE(choice.overlays.cells);
  ASSERT_TRUE(apply_view_command(parsed(R"({"command": "set_overlays", "cells": true})"), "test", choice));
  EXPECT_TRUE(choice.overlays.cells);
  ASSERT_TRUE(apply_view_command(
      parsed(R"({"command": "set_camera", "target_mm": [0, 0, 0], "distance_mm": 100})"), "test", choice));
  EXPECT_FALSE(choice.shows_whole_body);
}

TEST(ViewChoice, TellsTheStageOfContact) {
  ViewChoice choice;
  ASSERT_TRUE(apply_view_command(
      parsed(R"({"command": "set_overlays", "contact_stage": "spheres", "sphere_level": 3})"), "test",
      choice));
  EXPECT_EQ(choice.overlays.contact_stage, ContactStage::spheres);
  EXPECT_EQ(choice.overlays.sphere_level, 3);
  ASSERT_TRUE(apply_view_command(parsed(R"({"command": "set_overlays", "tool": false})"), "test", choice));
  EXPECT_EQ(choice.overlays.contact_stage, ContactStage::spheres) << "what is not named stays";
  for (const ContactStage stage : {ContactStage::none, ContactStage::hulls, ContactStage::spheres,
                                   ContactStage::triangles, ContactStage::contacts}) {
    choice.overlays.contact_stage = stage;
    const auto read = view_from_json(view_to_json(choice), "test");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->overlays.contact_stage, stage);
    EXPECT_EQ(read->overlays.sphere_level, 3);
  }
}

// Each error names the field.
TEST(ViewChoice, RefusesStagesThatAreNone) {
  for (const auto& [text, field] :
       {std::pair{R"({"command": "set_overlays", "contact_stage": "sphere"})", "contact_stage"},
        {R"({"command": "set_overlays", "contact_stage": 1})", "contact_stage"},
        {R"({"command": "set_overlays", "contact_stage": null})", "contact_stage"},
        {R"({"command": "set_overlays", "sphere_level": 4})", "sphere_level"},
        {R"({"command": "set_overlays", "sphere_level": -1})", "sphere_level"},
        {R"({"command": "set_overlays", "sphere_level": 1.5})", "sphere_level"},
        {R"({"command": "set_overlays", "contact_stage": "hulls", "sphere_level": "1"})", "sphere_level"}}) {
    ViewChoice choice;
    const Status applied = apply_view_command(parsed(text), "test", choice);
    ASSERT_FALSE(applied) << text;
    EXPECT_EQ(applied.error().field, field) << applied.error().message;
    EXPECT_EQ(choice.overlays.contact_stage, ContactStage::none);
  }
}

TEST(StageChoices, AreEachTheirOwn) {
  for (const StageChoice& chosen : stage_choices) {
    Overlays overlays;
    chosen.choose(overlays);
    int matches = 0;
    for (const StageChoice& other : stage_choices) matches += other.is_chosen(overlays) ? 1 : 0;
    EXPECT_EQ(matches, 1) << chosen.name;
    EXPECT_TRUE(chosen.is_chosen(overlays)) << chosen.name;
  }
}

TEST(ViewChoice, RefusesByName) {
  for (const char* text :
       {R"({"camera": {"yaw": 1}})", R"({"camera": {"pitch_deg": 95}})", R"({"camera": 3})",
        R"({"camera": {"distance_mm": 100}})", R"({"overlays": {"lattices": true}})",
        R"({"overlays": {"lattice": 1}})", R"({"light": 1})", R"([])"}) {
    EXPECT_FALSE(view_from_json(parsed(text), "test")) << text;
  }
  ViewChoice choice;
  EXPECT_FALSE(apply_view_command(parsed(R"({"command": "set_overlays", "tool": false, "net": true})"),
                                  "test", choice));
  EXPECT_TRUE(choice.overlays.tool);
}

}  // namespace
}  // namespace spoonbill
