#include "app/session/view_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/geometry.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;
constexpr Range<double> yaw_range_deg{-360.0, 360.0};
constexpr Range<double> pitch_range_deg{-89.0, 89.0};
constexpr Range<double> field_of_view_range_deg{5.0, 90.0};
constexpr Range<double> distance_range_m{0.001, 100.0};

constexpr std::array<std::pair<const char*, bool Overlays::*>, 13> overlay_fields = {{
    {"fixed_nodes", &Overlays::fixed_nodes},
    {"touched_nodes", &Overlays::touched_nodes},
    {"lattice", &Overlays::lattice},
    {"cells", &Overlays::cells},
    {"control_net", &Overlays::control_net},
    {"force", &Overlays::force},
    {"contact_normals", &Overlays::contact_normals},
    {"fixing_planes", &Overlays::fixing_planes},
    {"symmetry_plane", &Overlays::symmetry_plane},
    {"tool", &Overlays::tool},
    {"ground_grid", &Overlays::ground_grid},
    {"scale_bar", &Overlays::scale_bar},
    {"legend", &Overlays::legend},
}};

constexpr std::initializer_list<std::pair<const char*, ContactStage>> stage_names = {
    {"none", ContactStage::none},         {"hulls", ContactStage::hulls},
    {"spheres", ContactStage::spheres},   {"triangles", ContactStage::triangles},
    {"contacts", ContactStage::contacts},
};

void read_angle(FieldReader& reader, const char* field, Range<double> range_deg, double& angle_rad) {
  if (reader.has(field)) angle_rad = radians_per_degree * reader.number(field, range_deg);
}

void read_camera(FieldReader& reader, ViewChoice& choice) {
  Camera camera;
  camera.yaw_rad = radians_per_degree * 25.0;
  camera.pitch_rad = radians_per_degree * 20.0;
  read_angle(reader, "yaw_deg", yaw_range_deg, camera.yaw_rad);
  read_angle(reader, "pitch_deg", pitch_range_deg, camera.pitch_rad);
  read_angle(reader, "field_of_view_deg", field_of_view_range_deg, camera.vertical_field_of_view_rad);
  choice.shows_whole_body = !reader.has("target_mm") && !reader.has("distance_mm");
  if (!choice.shows_whole_body) {
    camera.target_m = reader.position_m("target_mm", position_range_m);
    camera.distance_m = reader.length_m("distance_mm", distance_range_m);
  }
  choice.camera = camera;
}

void read_overlays(FieldReader& reader, Overlays& overlays) {
  for (const auto& [field, member] : overlay_fields) {
    if (reader.has(field)) overlays.*member = reader.boolean(field);
  }
  if (reader.has("contact_stage")) overlays.contact_stage = reader.choice("contact_stage", stage_names);
  if (reader.has("sphere_level")) {
    overlays.sphere_level = reader.integer("sphere_level", {0, finest_stage_level});
  }
}

void read_see_through(FieldReader& reader, ViewChoice& choice) {
  if (reader.has("see_through_body")) choice.see_through_body = reader.boolean("see_through_body");
}

void add_camera(const ViewChoice& choice, Json& json) {
  const Camera& camera = choice.camera;
  const auto degrees = [](double rad, Range<double> range) {
    return number_to_json(std::clamp(rad / radians_per_degree, range.low, range.high));
  };
  json["yaw_deg"] = degrees(std::remainder(camera.yaw_rad, 2.0 * std::numbers::pi), yaw_range_deg);
  json["pitch_deg"] = degrees(camera.pitch_rad, pitch_range_deg);
  json["field_of_view_deg"] = degrees(camera.vertical_field_of_view_rad, field_of_view_range_deg);
  if (choice.shows_whole_body) return;
  json["target_mm"] = Json::array();
  const auto within = [](double metres, Range<double> range) {
    return length_to_json(std::clamp(metres, range.low, range.high));
  };
  for (int axis = 0; axis < 3; ++axis) {
    json["target_mm"].push_back(within(camera.target_m[axis], position_range_m));
  }
  json["distance_mm"] = within(camera.distance_m, distance_range_m);
}

void add_overlays(const Overlays& overlays, Json& json) {
  for (const auto& [field, member] : overlay_fields) json[field] = overlays.*member;
  for (const auto& [name, stage] : stage_names) {
    if (stage == overlays.contact_stage) json["contact_stage"] = name;
  }
  json["sphere_level"] = overlays.sphere_level;
}

std::string command_name(const Json& command) {
  const auto name = command.is_object() ? command.find("command") : command.end();
  return name != command.end() && name->is_string() ? name->get<std::string>() : std::string();
}

}  // namespace

Result<ViewChoice> view_from_json(const Json& view, const std::string& source) {
  const Json nothing = Json::object();
  ViewChoice choice;
  FieldReader reader(view, source + ": view");
  FieldReader default_camera(nothing, source);
  read_camera(default_camera, choice);
  if (reader.has("camera")) {
    FieldReader camera = reader.inner("camera");
    read_camera(camera, choice);
    camera.finish();
  }
  if (reader.has("overlays")) {
    FieldReader overlays = reader.inner("overlays");
    read_overlays(overlays, choice.overlays);
    overlays.finish();
  }
  read_see_through(reader, choice);
  if (reader.has("ground_mm")) choice.ground_y_m = reader.length_m("ground_mm", position_range_m);
  reader.finish();
  if (!reader.status()) return reader.status().error();
  return choice;
}

Json view_to_json(const ViewChoice& choice) {
  Json json;
  add_camera(choice, json["camera"]);
  add_overlays(choice.overlays, json["overlays"]);
  json["see_through_body"] = choice.see_through_body;
  if (choice.ground_y_m) json["ground_mm"] = length_to_json(*choice.ground_y_m);
  return json;
}

Json camera_command(const ViewChoice& choice) {
  Json json{{"command", "set_camera"}};
  add_camera(choice, json);
  return json;
}

Json overlays_command(const Overlays& overlays, bool see_through_body) {
  Json json{{"command", "set_overlays"}};
  add_overlays(overlays, json);
  json["see_through_body"] = see_through_body;
  return json;
}

bool is_view_command(const Json& command) {
  const std::string name = command_name(command);
  return name == "set_camera" || name == "set_overlays";
}

Status apply_view_command(const Json& command, const std::string& source, ViewChoice& choice) {
  ViewChoice changed = choice;
  FieldReader reader(command, source);
  reader.ignore("command");
  if (command_name(command) == "set_camera") {
    read_camera(reader, changed);
  } else {
    read_overlays(reader, changed.overlays);
    read_see_through(reader, changed);
  }
  reader.finish();
  if (!reader.status()) return reader.status();
  choice = changed;
  return {};
}

double choose_ground_y_m(std::optional<double> scene_ground_y_m, std::optional<double> view_ground_y_m,
                         double lowest_y_m) {
  return scene_ground_y_m.value_or(view_ground_y_m.value_or(lowest_y_m));
}

ViewSettings make_view_settings(const ViewChoice& choice, const Framing& framing, int width_px, int height_px,
                                const Rectangle& panel_px, double interface_scale) {
  ViewSettings settings;
  settings.camera = choice.camera;
  if (choice.shows_whole_body) {
    settings.camera = frame(choice.camera, framing.box, make_viewport(width_px, height_px, panel_px));
  }
  settings.panel_px = panel_px;
  settings.interface_scale = interface_scale;
  settings.overlays = choice.overlays;
  settings.see_through_body = choice.see_through_body;
  settings.goal = choice.goal;
  settings.ground_y_m = choose_ground_y_m(framing.scene_ground_y_m, choice.ground_y_m, framing.lowest_y_m);
  return settings;
}

}  // namespace spoonbill
