// Chooses the frames of a contact sheet by what happens in them: touch, release, the largest force, commands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace spoonbill {

// A frame on a contact sheet.
struct SheetFrame {
  std::uint64_t frame = 0;
  std::string caption;  // time and event, such as "0.72 s  largest force, 0.17 N"
};

// The events of the frames of a replay. One owner, one thread.
class FrameEvents {
 public:
  // Adds the next frame: its force on the hand, and the names of the commands since the frame before it.
  void add(std::uint64_t frame, double time_s, double force_n, const std::vector<std::string>& commands);

  // Returns at most `count` frames, at least 2, in their order: the first, the last, those with events, and
  // then others that halve the longest gaps. If there are too many events, the last kinds of this list are
  // thinned: largest force, touch, release, command.
  std::vector<SheetFrame> choose(std::size_t count) const;

 private:
  enum class Kind { end, largest_force, touch, release, command, none };
  struct Seen {
    std::uint64_t frame;
    double time_s;
    double force_n;
    Kind kind;
    std::string text;  // of the event
  };
  std::vector<Seen> classified() const;

  std::vector<Seen> seen_;
};

}  // namespace spoonbill
