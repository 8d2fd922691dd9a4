// What the window has shown, one JSON object a line and frame, for a program that works the window from
// outside and must know when something has happened: `spoonbill edit` with SPOONBILL_FRAME_LOG=FILE in its
// environment. One owner; the thread that draws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "engine/base/result.h"

namespace spoonbill {

// Each is a field of the line by the same name; the line has the frame's number besides.
struct ShownFrame {
  std::uint64_t tick = 0;
  std::uint64_t session = 0;  // grows whenever another session was opened
  std::uint64_t deed = 0;     // grows with every touch and command
  bool recording = false;
  bool in_stroke = false;
  bool can_undo = false;
  bool can_redo = false;
  bool pressing = false;  // the pointer's button is down on the picture
  std::string prompt;     // "file", "lump", "question", or empty
  std::string typed;      // in the file prompt
  double pointer_x_px = 0.0;
  double pointer_y_px = 0.0;
  double hand_lag_m = 0.0;  // from the device to where the mouse holds it
};

class FrameLog {
 public:
  // Replaces the file. Refused: a file that cannot be written.
  static Result<FrameLog> open(const std::filesystem::path& file);

  // After the frame was presented; the line is in the file when it returns. A full disk is not reported.
  void add(const ShownFrame& shown);

 private:
  explicit FrameLog(std::ofstream out) : out_(std::move(out)) {}

  std::ofstream out_;
  std::uint64_t frames_ = 0;
};

}  // namespace spoonbill
