// A video file made by an ffmpeg process that is fed raw pictures. The file appears under its name at
// finish(), or not at all. One owner, one thread. The process's SIGPIPE must be ignored (see main).
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

class VideoEncoder {
 public:
  // Whether ffmpeg is on the PATH.
  static bool available();

  // Starts ffmpeg; the ending of the file's name chooses the format. `frames_per_second` as a fraction.
  static Result<VideoEncoder> start(const std::filesystem::path& file, int width_px, int height_px,
                                    int rate_numerator, int rate_denominator);

  VideoEncoder(VideoEncoder&& other) noexcept;
  VideoEncoder& operator=(VideoEncoder&&) = delete;
  ~VideoEncoder();  // an unfinished video is thrown away

  // The picture must have the size given at the start.
  Status add(const Image& frame);
  Status finish();

 private:
  VideoEncoder(std::filesystem::path file, std::filesystem::path unfinished, pid_t process, int pipe)
      : file_(std::move(file)), unfinished_(std::move(unfinished)), process_(process), pipe_(pipe) {}
  int close_and_wait();

  std::filesystem::path file_;
  std::filesystem::path unfinished_;
  pid_t process_;  // -1 when none runs
  int pipe_;       // -1 when closed
};

}  // namespace spoonbill
