#include "app/session/training_session.h"

namespace spoonbill {
namespace {

// Returns the view of a task's document. The hand of the scene is far away, and the food hides nothing.
Json task_view() {
  return {{"camera", {{"yaw_deg", 25}, {"pitch_deg", 22}}},
          {"overlays", {{"tool", false}, {"touched_nodes", false}, {"force", false}}}};
}

}  // namespace

Document TrainingSetting::document() const {
  return {task.name, scene.scene, task_view()};
}

Result<TrainingSetting> read_training_setting(const TrainingChoice& choice) {
  auto task = read_task(choice.task);
  if (!task) return task.error();
  TrainingSetting setting;
  setting.task = std::move(task).value();
  setting.seed = choice.seed;
  if (!choice.hand.empty()) {
    auto hand = read_hand(choice.hand, choice.severity);
    if (!hand) return hand.error();
    setting.hand = std::move(hand).value();
  }
  auto scene = make_training_scene(setting.task, choice.spoon);
  if (!scene) return scene.error();
  setting.scene = std::move(scene).value();
  const std::filesystem::path& spoon = choice.spoon.empty() ? setting.task.spoon : choice.spoon;
  setting.identity = {{"task", setting.task.name},
                      {"spoon", spoon.stem().string()},
                      {"hand", setting.hand.name},
                      {"severity", setting.hand.severity},
                      {"seed", setting.seed}};
  return setting;
}

Result<Session> make_training_session(const TrainingSetting& setting, const std::string& source,
                                      const DeviceSpecification& device, InstructionSet set) {
  auto session = Session::make(setting.document(), source, device, set);
  if (!session) return session.error();
  if (Status laid = Training::lay_food(session->simulation); !laid) return laid.error().in(source);
  session->keeps_documents = false;
  session->training.emplace(setting.scene, setting.hand, setting.task.elbow_m, setting.seed);
  session->watch.emplace(setting.task, setting.scene, session->simulation);
  return session;
}

}  // namespace spoonbill
