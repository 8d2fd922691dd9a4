// The window in which a person trains a task: attempt after attempt, with the goal in the scene and the score
// at the end.
//
//   preparing --> ready --Enter--> running --> ended --Enter--> preparing
//
// Each attempt is a live session of its own. Its score comes from the haptic thread's ticks, so that a replay
// of the attempt's recording gives the same.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/edit/edit_window.h"
#include "app/edit/live_display.h"
#include "app/live/live_session.h"
#include "app/session/training_session.h"
#include "app/trainer/training_mouse.h"
#include "haptic/space_mouse.h"

namespace spoonbill {

// An attempt that has ended.
struct TrainedAttempt {
  TrainingSetting setting;
  TaskResult result;
  std::uint64_t state_hash = 0;
};

// Settings of the training window.
struct TrainerSettings {
  TrainingChoice choice;  // of the first attempt; each further one has the next seed
  int width = 1280;
  int height = 720;
  std::filesystem::path recording;  // receives each attempt, the last one stays; empty for none
  OutputOptions output;
  std::filesystem::path log;  // file of the log of the frames shown; empty for none
  InstructionSet instruction_set = best_instruction_set();
  // Returns the strength of the guidance of the next attempt; empty: that of `choice`.
  std::function<double()> choose_guidance = {};
  // Called after each attempt. An error is shown.
  std::function<Status(const TrainedAttempt&)> log_attempt = {};
};

// The window with its attempt. One owner: the program's main thread.
class Trainer {
 public:
  // Opens the window. Returns an error if there is no display, or if the task, the spoon or the hand cannot
  // be used.
  static Result<std::unique_ptr<Trainer>> make(const TrainerSettings& settings);
  ~Trainer();

  // Runs until the person quits.
  Status run();

  // Returns the attempt that ended last; empty if none has ended.
  const std::optional<TrainedAttempt>& last_attempt() const { return last_attempt_; }
  int attempt_count() const { return attempt_count_; }

 private:
  enum class Stage { preparing, ready, running, ended };
  // A session before its first tick, with what it is made of.
  struct Prepared {
    TrainingSetting setting;
    std::unique_ptr<Session> session;
  };

  Trainer(TrainerSettings settings, EditWindow window);

  void prepare();
  Status adopt_prepared();
  Status begin_attempt();
  void end_attempt();
  void give_up();

  Status frame(double seconds);
  void handle_keys();
  void handle_key(int key, bool ctrl, bool shift);
  void follow_attempt(double seconds);
  void move_hand(double seconds);
  void move_spoon(const Pointer& pointer, bool is_over_picture, double seconds);
  void move_finger(const Pointer& pointer, bool is_over_picture, double seconds);
  Status lay_out(double seconds);
  void draw_banner() const;
  void draw_key_list();
  ViewSettings find_view() const;
  ShownFrame shown_frame() const;
  bool has_spoon() const { return !setting_ || setting_->task.has_spoon(); }

  TrainerSettings settings_;
  EditWindow window_;
  Stage stage_ = Stage::preparing;
  std::future<Result<Prepared>> preparing_;
  std::optional<TrainingSetting> setting_;  // of the attempt that is shown; empty before the first
  std::unique_ptr<Session> session_;        // until the attempt begins
  std::unique_ptr<LiveSession> live_;       // while the attempt runs, and until the next is asked for
  LiveFrame shown_;                         // newest state of the attempt
  Framing framing_;
  ViewChoice view_;
  std::optional<HandInputs> inputs_;
  SpoonMouse spoon_mouse_;
  FingerMouse finger_mouse_{Vector3::Zero()};
  std::optional<SpaceMouse> space_mouse_;
  SurfacePick pick_;
  SpoonInput keyed_;  // turns by keys since the last frame
  bool press_began_here_ = false;
  bool guides_ = true;  // false once the person has switched the guidance off
  FrameBudget budget_;
  LivePlots plots_;
  MessageLine messages_;
  std::vector<float> forces_n_;
  std::optional<FrameLog> log_;
  double last_frame_s_ = 0.0;
  bool shows_keys_ = true;
  bool is_finished_ = false;
  std::optional<TrainedAttempt> last_attempt_;
  int attempt_count_ = 0;
};

}  // namespace spoonbill
