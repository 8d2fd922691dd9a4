#include "app/training/task.h"

#include "app/training/exact_angles.h"
#include "engine/base/file.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr int task_version = 1;
constexpr std::size_t task_file_limit_bytes = std::size_t{1} << 16;

void read_goal(FieldReader& reader, const std::filesystem::path& folder, Task& task) {
  if (task.kind == TaskKind::scoop) {
    task.dish = folder / reader.text("dish");
    task.dish_m = reader.position_m("dish_mm", task_place_range_m);
    return;
  }
  if (task.kind != TaskKind::level) task.mouth_m = reader.position_m("mouth_mm", task_place_range_m);
  if (task.kind == TaskKind::carry) task.reach_m = reader.length_m("reach_mm", task_reach_range_m);
  if (task.kind == TaskKind::eat)
    task.pitch_rad = degree_rad * reader.number("pitch_deg", task_pitch_range_deg);
  if (task.kind != TaskKind::carry)
    task.angle_rad = degree_rad * reader.number("angle_deg", task_angle_range_deg);
  if (task.kind == TaskKind::level) task.hold_s = reader.number("hold_s", task_time_range_s);
  if (task.kind == TaskKind::level && task.hold_s > task.time_limit_s)
    reader.refuse("hold_s", "must be at most time_limit_s", ErrorCode::inconsistent);
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
  if (reader.has("note")) reader.text("note");
  task.spoon = file.parent_path() / reader.text("spoon");
  if (const std::string name = reader.text("spoon_material"); reader.status().ok()) {
    auto material = read_named_material(name);
    if (!material) return material.error().in(file.string());
    task.spoon_material = std::move(material).value();
  }
  task.friction = reader.number("friction", study_friction_range);
  task.elbow_m = reader.position_m("elbow_mm", task_place_range_m);
  task.time_limit_s = reader.number("time_limit_s", task_time_range_s);
  if (reader.status().ok()) read_goal(reader, file.parent_path(), task);
  if (reader.status().ok()) {
    auto food = read_food(reader.inner("food"), file.parent_path());
    if (!food) return reader.status().ok() ? food.error().in(file.string()) : reader.status().error();
    task.food = std::move(food).value();
  }
  reader.finish();
  if (Status status = reader.status(); !status) return status.error();
  return task;
}

}  // namespace spoonbill
