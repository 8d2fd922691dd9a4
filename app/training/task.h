// A task that a person trains: what is on the spoon, where it goes, and when the task is done.
#pragma once

#include <filesystem>
#include <string>

#include "app/study/spoons_and_foods.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/material.h"

namespace spoonbill {

// scoop: food that lies in a dish is lifted out of it on the spoon. carry: the bowl reaches the mouth's
// place. level: the spoon is held level for some time. eat: the bowl passes the plane of the mouth, and the
// food slides off inside.
enum class TaskKind { scoop, carry, level, eat };
inline constexpr const char* task_kind_names[] = {"scoop", "carry", "level", "eat"};

// Plain data. Positions are relative to the centre of the spoon's rim at the start, when the bowl is level: x
// along the bowl to its front, y up.
struct Task {
  std::string name;
  TaskKind kind = TaskKind::carry;
  std::filesystem::path spoon;  // document of the usual spoon
  Material spoon_material;
  StudyFood food;
  double friction = 0.1;  // of food and spoon
  Vector3 elbow_m = Vector3(-0.33, 0.05, 0.0);
  double time_limit_s = 15.0;
  std::filesystem::path dish;         // scoop: document of the dish
  Vector3 dish_m = Vector3::Zero();   // scoop: place of the centre of the dish's rim
  Vector3 mouth_m = Vector3::Zero();  // carry and eat: place of the rim's centre
  double reach_m = 0.01;              // carry: distance from there at which it has arrived
  double angle_rad = 0.17;            // level, eat: largest deviation from the pitch asked for
  double pitch_rad = 0.0;             // eat: pitch at the mouth; positive lifts the front
  double hold_s = 10.0;               // level: time for which the spoon is held
};

inline constexpr Range<double> task_time_range_s{1.0, 120.0};
inline constexpr Range<double> task_place_range_m{-1.0, 1.0};
inline constexpr Range<double> task_reach_range_m{0.001, 0.1};
inline constexpr Range<double> task_angle_range_deg{0.5, 45.0};
inline constexpr Range<double> task_pitch_range_deg{-80.0, 80.0};

// Reads a task:
//
//   {"spoonbill_task": 1, "name": "carry", "kind": "carry", "spoon": "../models/spoon-original.json",
//    "spoon_material": "steel-304", "friction": 0.1,
//    "food": {"name": "gelatin", "material": "gelatin-20-1", "size_mm": [24, 12, 20]},
//    "elbow_mm": [-330, 50, 0], "time_limit_s": 15, "mouth_mm": [60, 120, 0], "reach_mm": 10}
//
// A scoop has "dish", a document, and dish_mm, where its rim's centre is; a carry has mouth_mm and reach_mm,
// a level task angle_deg and hold_s, an eat task mouth_mm, pitch_deg and angle_deg. Files are relative to
// that of the task.
Result<Task> read_task(const std::filesystem::path& file);

}  // namespace spoonbill
