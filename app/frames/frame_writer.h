// Writes numbered frames as PNG files on a thread of its own, so that encoding never holds up the drawing.
// The owner adds frames from one thread; the queue is bounded and add() waits while it is full.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

// "frame-0042.png".
std::string frame_file_name(int number);

// Makes the folder, or empties it of the frames and the contact sheet of an earlier run; other files stay.
// Refused, with the folder named, where it cannot be made or written to.
Status prepare_frame_folder(const std::filesystem::path& folder);

class FrameWriter {
 public:
  explicit FrameWriter(std::filesystem::path folder);
  ~FrameWriter();  // finishes what was added
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  // Both return the first failure of any frame so far; after one nothing more is written.
  Status add(int number, Image frame);
  Status finish();  // waits until the disk has all of them; nothing can be added afterwards

 private:
  void write_frames();

  const std::filesystem::path folder_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<std::pair<int, Image>> queue_;
  bool finishing_ = false;
  Status failure_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace spoonbill
