// Numbered frames of a session that its owner ticks, such as a trial.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "app/frames/frame_painter.h"
#include "app/frames/replay_pictures.h"
#include "app/session/session.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the framing of a training session: the bodies where they are and, with a spoon, at the mouth, and
// the goal.
Framing find_task_framing(const Task& task, const Session& session);

// Draws frames on several threads and writes them into a folder (prepare_frame_folder()). Frame k shows the
// state frame_tick(k) ticks after this object was made. Used by one thread.
class SessionFrames {
 public:
  // Sets what the panel shows beside the scene.
  using FillPanel = std::function<void(PanelModel&)>;

  // Draws every `every`-th frame. `framing` must show all that moves.
  SessionFrames(const std::filesystem::path& folder, const PictureSize& size, std::uint64_t every,
                const Framing& framing, const Session& session);

  // Draws the present state if a frame is due.
  Status draw(Session& session, const FillPanel& fill_panel = {});
  // Draws the state at the end, unless it is drawn already, as the frame whose time comes next.
  Status draw_end(Session& session, const FillPanel& fill_panel = {});
  // Waits until all frames are written.
  Status finish();

  // Returns the number of frames written so far.
  int count() const { return count_; }

 private:
  std::uint64_t find_next_frame(const Session& session);
  Status paint(Session& session, const FillPanel& fill_panel);
  Status write_oldest();

  PictureSize size_;
  std::uint64_t every_;
  Framing framing_;
  PaintingCrew crew_;
  FrameWriter writer_;
  std::uint64_t first_tick_;
  std::uint64_t next_frame_ = 0;
  std::optional<std::uint64_t> last_painted_;
  int count_ = 0;
};

}  // namespace spoonbill
