// A thread that draws as a window would during sculpting: 1280 x 720 without a display, antialiased, with
// shadow, a new shape in each frame, 60 frames per second or as many as it can.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/simulation/snapshot.h"

namespace spoonbill {

class DrawingLoad {
 public:
  // Draws the snapshots in rotation.
  explicit DrawingLoad(std::vector<Snapshot> snapshots);
  DrawingLoad(const DrawingLoad&) = delete;
  DrawingLoad& operator=(const DrawingLoad&) = delete;
  ~DrawingLoad();  // ends the thread

  int frames() const { return frames_; }
  // Returns an empty string if drawing works. Call it after the thread has had a moment to start.
  std::string error() const { return failed_ ? "nothing can be drawn here" : ""; }

 private:
  void draw();

  std::vector<Snapshot> snapshots_;
  std::atomic<int> frames_{0};
  std::atomic<bool> stop_{false}, failed_{false};
  std::thread thread_;
};

}  // namespace spoonbill
