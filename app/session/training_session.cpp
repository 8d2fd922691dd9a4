#include "app/session/training_session.h"

#include "app/session/task_goal.h"

namespace spoonbill {
namespace {

// Returns the view of a task's document. With a spoon, the tool of the scene is far away.
Json task_view(const Task& task) {
  if (!task.has_spoon()) {
    return {
        {"camera", {{"yaw_deg", 25}, {"pitch_deg", 35}}},
        {"overlays",
         {{"touched_nodes", false}, {"fixed_nodes", false}, {"fixing_planes", false}, {"legend", false}}}};
  }
  return {{"camera", {{"yaw_deg", 25}, {"pitch_deg", 22}}},
          {"overlays", {{"tool", false}, {"touched_nodes", false}, {"force", false}}}};
}

}  // namespace

Document TrainingSetting::document() const {
  return {task.name, scene.scene, task_view(task)};
}

Result<Script> read_task_script(const std::filesystem::path& file) {
  auto script = read_script(file);
  if (!script || script->commands.empty()) return script;
  return Error{ErrorCode::unsupported,
               script->commands.front().origin + ": a task has no commands; only motions steer it"};
}

Result<TrainingSetting> read_training_setting(const TrainingChoice& choice) {
  auto task = read_task(choice.task);
  if (!task) return task.error();
  TrainingSetting setting;
  setting.task = std::move(task).value();
  setting.seed = choice.seed;
  setting.guidance = choice.guidance;
  if (!choice.hand.empty()) {
    auto hand = read_hand(choice.hand, choice.severity);
    if (!hand) return hand.error();
    setting.hand = std::move(hand).value();
  }
  auto scene = make_training_scene(setting.task, choice.spoon, choice.seed);
  if (!scene) return scene.error();
  setting.scene = std::move(scene).value();
  const std::filesystem::path& spoon = choice.spoon.empty() ? setting.task.spoon : choice.spoon;
  setting.identity = {{"task", setting.task.name}, {"spoon", spoon.stem().string()},
                      {"hand", setting.hand.name}, {"severity", setting.hand.severity},
                      {"seed", setting.seed},      {"guidance", setting.guidance}};
  return setting;
}

Result<Session> make_training_session(const TrainingSetting& setting, const std::string& source,
                                      const DeviceSpecification& device, InstructionSet set) {
  auto session = Session::make(setting.document(), source, device, set);
  if (!session) return session.error();
  if (setting.task.has_spoon()) {
    if (Status laid = Training::lay_food(session->simulation); !laid) return laid.error().in(source);
  }
  session->keeps_documents = false;
  session->training.emplace(setting.scene, setting.hand, setting.task.elbow_m, setting.seed,
                            Guidance(setting.task.path_m, setting.guidance));
  session->watch.emplace(setting.task, setting.scene, session->simulation);
  session->view.goal =
      std::make_shared<const GoalMarks>(make_goal(setting.task, setting.scene, TrainingFacts()));
  return session;
}

}  // namespace spoonbill
