// A training session before its first tick, from the files that a person chooses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "app/session/session.h"
#include "app/training/hand_model.h"
#include "app/training/task.h"
#include "app/training/training_scene.h"
#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "haptic/script.h"

namespace spoonbill {

// Files and settings of a training session. Plain data; an empty path is the default.
struct TrainingChoice {
  std::filesystem::path task;
  std::filesystem::path spoon;     // default: that of the task
  std::filesystem::path hand;      // default: one that does all that is asked
  std::optional<double> severity;  // default: that of the hand's file
  std::uint32_t seed = 1;          // selects the tremor, and the place of a lump
  double guidance = 0.0;           // strength, in guidance_range
};

// A task, a spoon and a hand, as they are simulated. Plain data.
struct TrainingSetting {
  Task task;
  HandModel hand;
  TrainingScene scene;
  std::uint32_t seed = 1;
  double guidance = 0.0;
  Json identity;  // as in RecordingHeader::training

  // Returns the document that a recording of the session has, with a view of all of the task.
  Document document() const;
};

// Reads a script that steers a task. Refuses one with commands.
Result<Script> read_task_script(const std::filesystem::path& file);

// Reads the files. Errors are those of read_task(), read_hand() and make_training_scene().
Result<TrainingSetting> read_training_setting(const TrainingChoice& choice);

// Makes the session, with the food laid, a watch of the task and its goal in the view. `source` names the
// task's file in messages.
Result<Session> make_training_session(const TrainingSetting& setting, const std::string& source,
                                      const DeviceSpecification& device, InstructionSet set);

}  // namespace spoonbill
