#include "app/training/task.h"

#include "app/training/exact_angles.h"
#include "engine/base/file.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr int task_version = 1;
constexpr std::size_t task_file_limit_bytes = std::size_t{1} << 16;

Vector2 read_area(FieldReader& reader) {
  const Json& list = reader.list("area_mm", {2, 2});
  Vector2 area_m = Vector2::Zero();
  if (!list.is_array() || list.size() != 2) return area_m;
  for (std::size_t k = 0; k < 2; ++k) {
    const double length_m = list[k].is_number() ? 1e-3 * list[k].get<double>() : -1.0;
    if (!(length_m >= 0.0 && length_m <= task_place_range_m.high)) {
      reader.refuse("area_mm", "must be two lengths from 0 to 1000");
      return Vector2::Zero();
    }
    area_m[static_cast<int>(k)] = length_m;
  }
  return area_m;
}

void read_palpation(FieldReader& reader, const std::filesystem::path& folder, Task& task) {
  task.block = folder / reader.text("block");
  task.lump.tool_radius_m = reader.length_m("tool_radius_mm", lump_length_range_m);
  FieldReader lump = reader.inner("lump");
  task.lump.stiffness_ratio = lump.number("stiffness_ratio", lump_stiffness_range);
  task.lump.radius_m = lump.length_m("radius_mm", lump_length_range_m);
  task.lump.depth_m = lump.length_m("depth_mm", lump_length_range_m);
  task.lump.area_m = read_area(lump);
  lump.text("source");
  lump.finish();
}

void read_goal(FieldReader& reader, const std::filesystem::path& folder, Task& task) {
  const TaskKind kind = task.kind;
  if (kind == TaskKind::scoop) {
    task.dish = folder / reader.text("dish");
    task.dish_m = reader.position_m("dish_mm", task_place_range_m);
  }
  if (kind == TaskKind::carry || kind == TaskKind::eat) {
    task.mouth_m = reader.position_m("mouth_mm", task_place_range_m);
  }
  if (kind == TaskKind::carry || kind == TaskKind::palpate) {
    task.reach_m = reader.length_m("reach_mm", task_reach_range_m);
  }
  if (kind == TaskKind::eat) task.pitch_rad = degree_rad * reader.number("pitch_deg", task_pitch_range_deg);
  if (kind == TaskKind::level || kind == TaskKind::eat) {
    task.angle_rad = degree_rad * reader.number("angle_deg", task_angle_range_deg);
  }
  if (kind == TaskKind::level) task.hold_s = reader.number("hold_s", task_time_range_s);
  if (kind == TaskKind::level && task.hold_s > task.time_limit_s) {
    reader.refuse("hold_s", "must be at most time_limit_s", ErrorCode::inconsistent);
  }
  if (kind == TaskKind::palpate) read_palpation(reader, folder, task);
}

std::vector<Vector3> find_usual_path(const Task& task) {
  if (task.kind == TaskKind::level) return {Vector3::Zero()};
  if (task.kind == TaskKind::carry || task.kind == TaskKind::eat) return {Vector3::Zero(), task.mouth_m};
  return {};
}

std::vector<Vector3> read_path(FieldReader& reader) {
  std::vector<Vector3> path_m;
  const Json& list = reader.list("path_mm", task_path_size_range);
  if (!list.is_array()) return path_m;
  for (const Json& corner : list) {
    Vector3 corner_m = Vector3::Zero();
    bool is_right = corner.is_array() && corner.size() == 3;
    for (std::size_t k = 0; is_right && k < 3; ++k) {
      is_right = corner[k].is_number() && task_place_range_m.contains(1e-3 * corner[k].get<double>());
      if (is_right) corner_m[static_cast<int>(k)] = 1e-3 * corner[k].get<double>();
    }
    if (!is_right) {
      reader.refuse("path_mm", "must be a list of positions, each of three lengths from -1000 to 1000");
      return {};
    }
    path_m.push_back(corner_m);
  }
  return path_m;
}

// Reads the spoon, its material, its friction and the food.
Status read_load(FieldReader& reader, const std::filesystem::path& file, Task& task) {
  task.spoon = file.parent_path() / reader.text("spoon");
  if (const std::string name = reader.text("spoon_material"); reader.status().ok()) {
    auto material = read_named_material(name);
    if (!material) return material.error().in(file.string());
    task.spoon_material = std::move(material).value();
  }
  task.friction = reader.number("friction", study_friction_range);
  if (!reader.status().ok()) return reader.status();
  auto food = read_food(reader.inner("food"), file.parent_path());
  if (!food) return reader.status().ok() ? food.error().in(file.string()) : reader.status();
  task.food = std::move(food).value();
  return {};
}

}  // namespace

Result<Task> read_task(const std::filesystem::path& file) {
  const auto text = read_file(file, task_file_limit_bytes);
  if (!text) return text.error();
  const auto json = parse_json(text.value(), file.string());
  if (!json) return json.error();
  FieldReader reader(json.value(), file.string());
  reader.version("spoonbill_task", task_version);
  Task task;
  task.name = reader.text("name");
  task.kind = static_cast<TaskKind>(reader.choose("kind", task_kind_names));
  if (reader.has("note")) task.note = reader.text("note");
  task.elbow_m = reader.position_m("elbow_mm", task_place_range_m);
  task.time_limit_s = reader.number("time_limit_s", task_time_range_s);
  if (reader.status().ok()) read_goal(reader, file.parent_path(), task);
  const bool has_path = task.has_spoon() && reader.has("path_mm");
  task.path_m = has_path ? read_path(reader) : find_usual_path(task);
  if (reader.status().ok() && task.has_spoon()) {
    if (Status loaded = read_load(reader, file, task); !loaded) return loaded.error();
  }
  reader.finish();
  if (Status status = reader.status(); !status) return status.error();
  return task;
}

}  // namespace spoonbill
