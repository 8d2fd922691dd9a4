// Live information over the picture: the last messages, and plots of force and tick rate.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <vector>

#include "app/live/journal.h"
#include "app/panel/interface_context.h"
#include "haptic/haptic_loop.h"

namespace spoonbill {

// The last messages, at the lower edge of the picture for a few seconds. One owner: the thread that draws.
class MessageLine {
 public:
  void add(Notice notice) { shown_.push_back({std::move(notice), seconds_to_read}); }
  void add_problem(std::string text) { add({Notice::Kind::problem, std::move(text)}); }

  // Draws the messages, between begin_frame() and end_frame(). `corner_px` is the lower left corner of the
  // picture.
  void draw(const Theme& theme, const ImVec2& corner_px, double seconds);

 private:
  static constexpr double seconds_to_read = 6.0;
  static constexpr std::size_t lines_limit = 4;
  struct Shown {
    Notice notice;
    double seconds_left;
  };
  std::deque<Shown> shown_;
};

// Small plots of the device force over the last 2 s and of the haptic thread's rate over the last minute. One
// owner: the thread that draws.
class LivePlots {
 public:
  // Adds the forces since the last frame and the figures of the loop. Called once per frame.
  void add(const std::vector<float>& forces_n, const LoopFigures& loop, double seconds);

  // Draws the plots, between begin_frame() and end_frame(). `corner_px` is the upper right corner of the
  // picture.
  void draw(const Theme& theme, const ImVec2& corner_px, double force_limit_n) const;

 private:
  static constexpr std::size_t force_count = 2000;
  static constexpr std::size_t rate_count = 120;
  static constexpr double rate_interval_s = 0.5;

  std::array<float, force_count> forces_n_{};
  std::size_t next_force_ = 0;
  std::array<float, rate_count> rates_hz_{};
  std::size_t next_rate_ = 0;
  double since_rate_s_ = 0.0;
  LoopFigures loop_;
};

}  // namespace spoonbill
