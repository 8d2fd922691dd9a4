// A task that a person trains: what is on the spoon or under the finger, where it goes, and when the task is
// done.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/study/spoons_and_foods.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/material.h"

namespace spoonbill {

// scoop: food that lies in a dish is lifted out of it on the spoon. carry: the bowl reaches the mouth's
// place. level: the spoon is held level for some time. eat: the bowl passes the plane of the mouth, and the
// food slides off inside. palpate: a finger searches a soft block for a stiff lump under its skin and marks
// the place.
enum class TaskKind { scoop, carry, level, eat, palpate };
inline constexpr const char* task_kind_names[] = {"scoop", "carry", "level", "eat", "palpate"};

// A stiff lump under the skin of a soft block. Plain data.
struct LumpModel {
  double stiffness_ratio = 20.0;  // of its Young's modulus to that of the block
  double radius_m = 0.006;
  double depth_m = 0.003;            // of its upper side below the skin
  Vector2 area_m = Vector2::Zero();  // size along x and z of the area, about the block's centre, that has it
  double tool_radius_m = 0.006;      // of the finger
};

// Plain data. Positions are relative to the centre of the spoon's rim at the start, when the bowl is level: x
// along the bowl to its front, y up. Those of a palpation are relative to the block's document.
struct Task {
  std::string name, note;
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
  double reach_m = 0.01;        // carry: distance from there at which it has arrived; palpate: largest error
  double angle_rad = 0.17;      // level, eat: largest deviation from the pitch asked for
  double pitch_rad = 0.0;       // eat: pitch at the mouth; positive lifts the front
  double hold_s = 10.0;         // level: time for which the spoon is held
  std::vector<Vector3> path_m;  // corners of the usual path of the rim's centre; empty for none
  std::filesystem::path block;  // palpate: document of the block
  LumpModel lump;               // palpate

  bool has_spoon() const { return kind != TaskKind::palpate; }
};

inline constexpr Range<double> task_time_range_s{1.0, 120.0};
inline constexpr Range<double> task_place_range_m{-1.0, 1.0};
inline constexpr Range<double> task_reach_range_m{0.001, 0.1};
inline constexpr Range<double> task_angle_range_deg{0.5, 45.0};
inline constexpr Range<double> task_pitch_range_deg{-80.0, 80.0};
inline constexpr Range<int> task_path_size_range{1, 100};
inline constexpr Range<double> lump_stiffness_range{1.5, 100.0};
inline constexpr Range<double> lump_length_range_m{0.001, 0.05};

// Reads a task:
//
//   {"spoonbill_task": 1, "name": "carry", "kind": "carry", "spoon": "../models/spoon-original.json",
//    "spoon_material": "steel-304", "friction": 0.1,
//    "food": {"name": "gelatin", "material": "gelatin-20-1", "size_mm": [24, 12, 20]},
//    "elbow_mm": [-330, 50, 0], "time_limit_s": 15, "mouth_mm": [60, 120, 0], "reach_mm": 10}
//
// A scoop has "dish", a document, and dish_mm, where its rim's centre is; a carry has mouth_mm and reach_mm,
// a level task angle_deg and hold_s, an eat task mouth_mm, pitch_deg and angle_deg. Files are relative to
// that of the task. Every task may have a "note" for the person, and every task with a spoon "path_mm", a
// list of positions. Without it, the path of a carry or an eat task is straight from the start to the mouth,
// a level task stays at the start, and a scoop has none.
//
// A palpation has no spoon, food or friction, but
//
//   "block": "../models/tissue.json", "tool_radius_mm": 6, "reach_mm": 5,
//   "lump": {"stiffness_ratio": 20, "radius_mm": 6, "depth_mm": 3, "area_mm": [30, 20],
//            "source": "..."}
Result<Task> read_task(const std::filesystem::path& file);

}  // namespace spoonbill
