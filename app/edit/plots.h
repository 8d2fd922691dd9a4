// The last two seconds of the force on the hand, and the last minute of the haptic thread's rate, as small
// plots in the corner of the picture.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "app/panel/theme.h"
#include "haptic/haptic_loop.h"

namespace spoonbill {

// Plain data; one owner, the thread that draws.
class LivePlots {
 public:
  // Once a frame: the forces since the last one, and how the loop does.
  void add(const std::vector<float>& forces_n, const LoopFigures& loop, double seconds);

  // Between begin_frame() and end_frame(); the right upper corner of the picture is given.
  void draw(const Theme& theme, const ImVec2& corner_px, double force_limit_n) const;

 private:
  static constexpr std::size_t force_count = 2000;
  static constexpr std::size_t rate_count = 120;
  static constexpr double seconds_between_rates = 0.5;

  std::array<float, force_count> forces_n_{};
  std::size_t next_force_ = 0;
  std::array<float, rate_count> rates_hz_{};
  std::size_t next_rate_ = 0;
  double since_rate_s_ = 0.0;
  LoopFigures loop_;
};

}  // namespace spoonbill
