// What to leave out of the picture so that the interface holds its rate: a pure policy over the times of the
// last frames. The caller measures; nothing here reads a clock. One owner; the drawing thread.
//
//   FrameBudget budget;
//   budget.apply(settings);                  // before each frame
//   renderer.draw(snapshot, settings, ...);
//   budget.add_frame(seconds_it_took);       // after each frame: drawing and presenting, without waiting
#pragma once

#include <string>

#include "render/view_settings.h"

namespace spoonbill {

// In the order in which they are given up.
enum class FrameQuality { full, no_samples, no_shadow, coarse };

class FrameBudget {
 public:
  // `frame_s` is the time that a frame may take, above 0.
  explicit FrameBudget(double frame_s = 1.0 / 60.0) : frame_s_(frame_s) {}

  // Takes note of a frame drawn at quality(). Late frames in a row, or more than a third of them, lower the
  // quality; long room raises it. A single late frame changes nothing: the machine may have been
  // elsewhere. A quality that proved too slow soon after it was tried again waits longer each time.
  void add_frame(double took_s);

  FrameQuality quality() const { return quality_; }

  // Lowers what the person chose; never raises it.
  void apply(ViewSettings& settings) const;

  // One line for the panel about what is missing, empty at full quality.
  std::string text() const;

 private:
  void change(FrameQuality quality);
  void look_for_room(double took_s);

  double frame_s_;
  FrameQuality quality_ = FrameQuality::full;
  int late_frames_ = 0;        // of the last ones, weighed: see add_frame()
  int roomy_frames_ = 0;       // in a row
  int frames_here_ = 0;        // since the quality changed
  int patience_frames_ = 120;  // roomy frames before the next better quality is tried
  bool on_trial_ = false;      // the quality was raised last, not lowered
};

}  // namespace spoonbill
