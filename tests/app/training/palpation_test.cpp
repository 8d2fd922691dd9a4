// Tests palpation: the place of the lump, how it feels, and the judgement of a mark.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "app/program.h"
#include "app/training/palpation_scene.h"
#include "app/training/task_watch.h"
#include "app/training/training.h"
#include "engine/base/processor.h"
#include "haptic/virtual_device.h"
#include "tests/app/workplace.h"
#include "tests/engine/allocations.h"

namespace spoonbill {
namespace {

Task palpation() {
  return read_task(std::filesystem::path(SPOONBILL_ASSETS) / "tasks/palpate.json").value();
}

// A finger over the block of a palpation, with the hand that does all that is asked.
struct Palpation {
  explicit Palpation(std::uint32_t seed)
      : scene(make_palpation_scene(task, seed).value()),
        simulation(Simulation::make(scene.scene, best_instruction_set()).value()),
        training(scene, HandModel(), task.elbow_m, seed),
        watch(task, scene, simulation) {}

  TickResult tick(const Vector3& finger_m, std::uint32_t buttons = 0) {
    const TickResult result = training.tick(simulation, coupling, VirtualDevice::default_specification(),
                                            DeviceReading::from({finger_m, Quaternion::Identity()}, buttons));
    watch.follow(simulation, training, result.force_n);
    return result;
  }
  // Presses from above down to `depth_m` below the skin, and returns the force there.
  double press(double x_m, double z_m, double depth_m) {
    constexpr int ticks = 600;
    const double top_m = find_bounds(scene.scene.bodies[0]).high.y() + task.lump.tool_radius_m;
    TickResult result;
    for (int k = 0; k <= ticks; ++k)
      result = tick(Vector3(x_m, top_m + 0.005 - (0.005 + depth_m) * k / ticks, z_m));
    for (int k = 0; k < 200; ++k) result = tick(Vector3(x_m, top_m - depth_m, z_m));
    return result.force_n.norm();
  }

  Task task = palpation();
  TrainingScene scene;
  Simulation simulation;
  Training training;
  TaskWatch watch;
  CouplingState coupling;
};

TEST(Palpation, LumpIsInItsAreaAndUnderTheSkin) {
  const Task task = palpation();
  Vector3 first_m = Vector3::Zero();
  bool differs = false;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto scene = make_palpation_scene(task, seed);
    ASSERT_TRUE(scene) << scene.error().message;
    const Box block = find_bounds(scene->scene.bodies.front());
    const Vector3& lump_m = *scene->lump_m;
    constexpr double cell_m = 0.0031;  // the lump is made of whole cells
    EXPECT_LE(std::abs(lump_m.x()), 0.5 * task.lump.area_m.x() + cell_m);
    EXPECT_LE(std::abs(lump_m.z()), 0.5 * task.lump.area_m.y() + cell_m);
    EXPECT_NEAR(block.high.y() - lump_m.y(), task.lump.depth_m + task.lump.radius_m, cell_m);
    if (seed == 1) first_m = lump_m;
    differs |= (lump_m - first_m).norm() > 0.01;
  }
  EXPECT_TRUE(differs);
  EXPECT_EQ(*make_palpation_scene(task, 7)->lump_m, *make_palpation_scene(task, 7)->lump_m);
}

// A finger that presses 5 mm deep feels the lump as a quarter more force at least.
TEST(Palpation, LumpIsFelt) {
  Palpation over(1), beside(1);
  const Vector3 lump_m = *over.scene.lump_m;
  const double over_n = over.press(lump_m.x(), lump_m.z(), 0.005);
  const double beside_n = beside.press(lump_m.x(), -lump_m.z(), 0.005);
  EXPECT_GT(beside_n, 0.1);
  EXPECT_GT(over_n, 1.25 * beside_n);
  EXPECT_FALSE(over.watch.has_ended());
}

TEST(Palpation, MarkCountsOnlyWhereTheFingerTouches) {
  Palpation palpation(1);
  const Vector3 lump_m = *palpation.scene.lump_m;
  palpation.tick(palpation.scene.start_m, button_main);
  EXPECT_FALSE(palpation.watch.has_ended());
  palpation.press(lump_m.x() + 0.004, lump_m.z() + 0.003, 0.004);
  const double top_m =
      find_bounds(palpation.scene.scene.bodies[0]).high.y() + palpation.task.lump.tool_radius_m;
  palpation.tick(Vector3(lump_m.x() + 0.004, top_m - 0.004, lump_m.z() + 0.003), button_main);
  const TaskResult result = palpation.watch.result();
  EXPECT_EQ(result.end, TaskEnd::success);
  ASSERT_TRUE(result.error_m);
  EXPECT_NEAR(*result.error_m, 0.005, 1e-6);
  const double used = 50.0 * result.time_s / palpation.task.time_limit_s;
  EXPECT_NEAR(result.score(palpation.task), 100.0 - used - 50.0 * 0.005 / palpation.task.reach_m, 0.01);
}

TEST(Palpation, TickAllocatesNothing) {
  if (assertions_allocate) GTEST_SKIP() << only_without_debug_assertions;
  Palpation palpation(1);
  palpation.press(0.0, 0.0, 0.002);
  const std::size_t before = allocation_count();
  palpation.press(0.0, 0.0, 0.004);
  EXPECT_EQ(allocation_count(), before);
}

TEST(Palpation, WrongBlocksAndSpoonsGetOneLine) {
  const Workplace place;
  const std::string assets = SPOONBILL_ASSETS, task = assets + "/tasks/palpate.json";
  const std::string script = assets + "/recordings/palpate.script.json";
  EXPECT_TRUE(is_clean_failure(
      run({"train", task, "--script", script, "--spoon", assets + "/models/spoon-original.json"})));
  const auto refuses = [&](const std::string& field, const Json& value) {
    std::ifstream file(task);
    Json json = Json::parse(file);
    json["block"] = assets + "/models/tissue.json";
    json[field] = value;
    return is_clean_failure(run({"train", place.write("task.json", json.dump()), "--script", script}));
  };
  EXPECT_TRUE(refuses("block", assets + "/models/jelly-on-spoon.json"));
  EXPECT_TRUE(refuses("block", assets + "/models/missing.json"));
  EXPECT_TRUE(refuses("block", assets + "/models/spoon-bent.json"));
  EXPECT_TRUE(refuses("lump", {{"stiffness_ratio", 13},
                               {"radius_mm", 1},
                               {"depth_mm", 3},
                               {"area_mm", {30, 20}},
                               {"source", "a test"}}));
  EXPECT_TRUE(refuses("lump", {{"stiffness_ratio", 13},
                               {"radius_mm", 30},
                               {"depth_mm", 40},
                               {"area_mm", {30, 20}},
                               {"source", "a test"}}));
}

}  // namespace
}  // namespace spoonbill
