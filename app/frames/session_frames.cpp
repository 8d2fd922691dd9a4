#include "app/frames/session_frames.h"

#include <utility>

#include "app/session/lockstep.h"
#include "app/session/task_goal.h"

namespace spoonbill {

Framing find_task_framing(const Task& task, const Session& session) {
  Snapshot start;
  write_snapshot(session, start);
  Framing framing = find_framing(session.simulation.scene(), start);
  const Box box = framing.box;
  for (const int c : {0, 7}) framing.box.include(box.corner(c) + task.mouth_m);
  if (session.view.goal) framing.box.join(find_bounds(*session.view.goal));
  return framing;
}

SessionFrames::SessionFrames(const std::filesystem::path& folder, const PictureSize& size,
                             std::uint64_t every, const Framing& framing, const Session& session)
    : size_(size),
      every_(every),
      framing_(framing),
      crew_(size.width_px, size.height_px),
      writer_(folder),
      first_tick_(session.simulation.tick()) {}

// Returns the number of ticks so far, and moves on to the frame that is due then or later.
std::uint64_t SessionFrames::find_next_frame(const Session& session) {
  const std::uint64_t ticks = session.simulation.tick() - first_tick_;
  while (frame_tick(next_frame_) < ticks) ++next_frame_;
  return ticks;
}

Status SessionFrames::draw(Session& session, const FillPanel& fill_panel) {
  const std::uint64_t ticks = find_next_frame(session);
  const bool is_due = frame_tick(next_frame_) == ticks && next_frame_ % every_ == 0;
  return is_due ? paint(session, fill_panel) : Status();
}

Status SessionFrames::draw_end(Session& session, const FillPanel& fill_panel) {
  find_next_frame(session);
  return last_painted_ == next_frame_ ? Status() : paint(session, fill_panel);
}

Status SessionFrames::finish() {
  while (crew_.in_flight() > 0) {
    if (Status written = write_oldest(); !written) return written;
  }
  return writer_.finish();
}

Status SessionFrames::paint(Session& session, const FillPanel& fill_panel) {
  if (crew_.is_full()) {
    if (Status written = write_oldest(); !written) return written;
  }
  PaintingJob job = make_painting_job(next_frame_, session, framing_, size_);
  if (fill_panel) fill_panel(job.panel);
  session.flags = tick_flag_none;
  crew_.start(std::move(job));
  last_painted_ = next_frame_;
  return {};
}

Status SessionFrames::write_oldest() {
  auto painted = crew_.receive();
  if (!painted) return painted.error();
  ++count_;
  return writer_.add(static_cast<int>(painted->frame), std::move(painted->picture));
}

}  // namespace spoonbill
