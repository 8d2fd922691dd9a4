#include "app/training/training_scene.h"

#include <Eigen/Geometry>
#include <numbers>

#include "app/study/case_trial.h"
#include "app/study/spoon_measures.h"
#include "app/training/palpation_scene.h"
#include "app/training/wrist.h"
#include "engine/scene/place_body.h"

namespace spoonbill {
namespace {

const Vector3 up = Vector3::UnitY();
constexpr double shortest_handle_m = 0.02;
constexpr double gripped_fraction = 1.0 / 3.0;  // of the handle's length, from its end
// A coarser lattice than that of a study leaves time for drawing beside the ticks.
constexpr int food_refinement = -1;
// The hand gives way as the force of a usual device does, so that the device can render its spring.
constexpr HandSpring training_spring{700.0, 3.0};

Pose turn_about(const Vector3& point_m, const Quaternion& turn) {
  return {point_m - turn * point_m, turn};
}

// Turns a spoon until its bowl is level with the front along x, and moves the rim's centre to the origin.
Status level_spoon(StudySpoon& spoon) {
  spoon.body.rim = spoon.bowl.rim;
  const Bowl& bowl = spoon.bowl;
  const Vector3 level_front = (bowl.front - up.dot(bowl.front) * up).normalized();
  const Quaternion turn =
      Quaternion::FromTwoVectors(level_front, Vector3::UnitX()) * Quaternion::FromTwoVectors(bowl.normal, up);
  move_body(turn_about(bowl.centre_m, turn), spoon.body);
  move_body({-bowl.centre_m, Quaternion::Identity()}, spoon.body);
  auto found = find_bowl(spoon.body, up);
  if (!found) return found.error();
  spoon.bowl = std::move(found).value();
  return {};
}

Result<HeldSpoon> find_grip(const StudySpoon& spoon) {
  const Handle handle = find_handle(spoon);
  if (handle.length_m < shortest_handle_m) {
    return Error{ErrorCode::unsupported,
                 spoon.file.string() + ": the spoon has no handle that a hand could hold"};
  }
  const auto section = [&](double fraction) { return find_section(spoon, fraction * handle.length_m); };
  HeldSpoon held;
  held.grip_m = section(gripped_fraction).centre_m;
  held.handle_width_m = section(gripped_fraction).width_m;
  held.handle = Quaternion(
      find_forearm(section(0.5 * gripped_fraction).centre_m, section(1.5 * gripped_fraction).centre_m));
  held.spring = training_spring;
  return held;
}

// Order of the bodies that make_case_scene() returns.
constexpr int food_index = 0;
constexpr std::size_t bearer_index = 1;

// Returns the scene of the food just above what bears it.
Result<Scene> lay_on(const Task& task, const StudySpoon& bearer) {
  StudyPlan plan;
  plan.spoons = {bearer};
  plan.foods = {task.food};
  StudyCase laid;
  laid.spoon = bearer.name;
  laid.food = task.food.name;
  laid.friction = task.friction;
  laid.refinement = food_refinement;
  auto scene = make_case_scene(plan, laid);
  if (!scene) return scene.error().in(bearer.file.string());
  return scene;
}

Result<Scene> lay_in_dish(const Task& task, double& dish_top_m) {
  auto dish = read_spoon(task.dish);
  if (!dish) return dish.error();
  move_body({task.dish_m - dish->bowl.centre_m, Quaternion::Identity()}, dish->body);
  dish->bowl.centre_m = task.dish_m;
  dish_top_m = bounding_box(dish->body.surface.net).high.y();
  auto scene = lay_on(task, dish.value());
  if (!scene) return scene;
  Body& body = scene->bodies[bearer_index];
  body.name = "dish";
  body.rim.clear();  // the spoon's rim is the one that counts
  return scene;
}

}  // namespace

Result<TrainingScene> make_training_scene(const Task& task, const std::filesystem::path& file,
                                          std::uint32_t seed) {
  if (!task.has_spoon()) {
    if (!file.empty()) return Error{ErrorCode::unsupported, "the task " + task.name + " has no spoon"};
    return make_palpation_scene(task, seed);
  }
  auto spoon = read_spoon(file.empty() ? task.spoon : file);
  if (!spoon) return spoon.error();
  if (Status level = level_spoon(spoon.value()); !level) return level.error().in(spoon->file.string());
  spoon->body.material = task.spoon_material;
  auto held = find_grip(spoon.value());
  if (!held) return held.error();
  spoon->body.name = "spoon";
  spoon->body.kind = BodyKind::rigid;
  spoon->body.hand = training_spring;
  spoon->body.material.friction = task.friction;
  double dish_top_m = 0.0;
  auto scene = task.kind == TaskKind::scoop ? lay_in_dish(task, dish_top_m) : lay_on(task, spoon.value());
  if (!scene) return scene.error();
  scene->trial->turned_body.clear();
  if (task.kind == TaskKind::scoop) {
    scene->bodies.push_back(spoon->body);
  } else {
    scene->bodies[bearer_index] = spoon->body;
  }
  held->body = static_cast<int>(scene->bodies.size()) - 1;
  TrainingScene made;
  made.scene = std::move(scene).value();
  made.food = food_index;
  made.dish_top_m = dish_top_m;
  made.spoon = held.value();
  return made;
}

}  // namespace spoonbill
