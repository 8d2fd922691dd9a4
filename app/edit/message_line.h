// The last messages, at the lower edge of the picture for a few seconds. One owner; the thread that draws.
#pragma once

#include <deque>

#include "app/live/notices.h"
#include "app/panel/theme.h"

namespace spoonbill {

class MessageLine {
 public:
  void add(Notice notice) { shown_.push_back({std::move(notice), seconds_to_read}); }
  void add_problem(std::string text) { add({Notice::Kind::problem, std::move(text)}); }

  // Between begin_frame() and end_frame(); the left lower corner of the picture is given.
  void draw(const Theme& theme, const ImVec2& corner_px, double seconds);

 private:
  static constexpr double seconds_to_read = 6.0;
  static constexpr std::size_t most_lines = 4;
  struct Shown {
    Notice notice;
    double seconds_left;
  };
  std::deque<Shown> shown_;
};

}  // namespace spoonbill
