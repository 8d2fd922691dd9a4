// Paints frames on threads, each with a painter of its own, while the owner prepares the next ones. The
// painters take turns in a fixed order, so the same frames come out on any machine and load. One owner, one
// thread:
//
//   while (more) {
//     if (crew.is_full()) take(crew.take());
//     crew.start(job);
//   }
//   while (crew.in_flight() > 0) take(crew.take());
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "app/frames/frame_painter.h"

namespace spoonbill {

// All that a frame shows, as values: the session may go on.
struct PaintingJob {
  std::uint64_t frame = 0;
  Snapshot snapshot;
  ViewSettings view;
  PanelModel panel;
  std::vector<std::string> also_as;  // other names that the picture is kept under
};

struct PaintedFrame {
  std::uint64_t frame = 0;
  double time_s = 0.0;
  Image picture;
  std::vector<std::string> also_as;
};

class PaintingCrew {
 public:
  PaintingCrew(int width_px, int height_px);
  ~PaintingCrew();  // what has not been taken is thrown away
  PaintingCrew(const PaintingCrew&) = delete;
  PaintingCrew& operator=(const PaintingCrew&) = delete;

  bool is_full() const;
  int in_flight() const { return static_cast<int>(started_ - taken_); }

  // Only while there is room.
  void start(PaintingJob job);

  // Waits for the oldest frame started; there must be one. The error is that of its painter, which cannot
  // paint any more: throw the crew away.
  Result<PaintedFrame> take();

 private:
  class Painter;

  std::mutex interface_turn_;  // see FramePainter::make()
  std::vector<std::unique_ptr<Painter>> painters_;
  std::uint64_t started_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace spoonbill
