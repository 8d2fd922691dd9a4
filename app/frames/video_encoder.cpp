#include "app/frames/video_encoder.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/process/child_process.h"
#include "engine/base/assert.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

std::vector<std::string> ffmpeg_arguments(const std::filesystem::path& file, const std::string& size,
                                          const std::string& rate) {
  // Most players want even sides.
  return {"ffmpeg",
          "-y",
          "-loglevel",
          "error",
          "-f",
          "rawvideo",
          "-pix_fmt",
          "rgba",
          "-s",
          size,
          "-r",
          rate,
          "-i",
          "pipe:0",
          "-vf",
          "pad=ceil(iw/2)*2:ceil(ih/2)*2",
          "-pix_fmt",
          "yuv420p",
          "file:" + file.string()};
}

}  // namespace

bool VideoEncoder::available() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/ffmpeg").c_str(), X_OK) == 0) return true;
  }
  return false;
}

Result<VideoEncoder> VideoEncoder::start(const std::filesystem::path& file, int width_px, int height_px,
                                         int rate_numerator, int rate_denominator) {
  SPOONBILL_ASSERT(width_px > 0 && height_px > 0);
  SPOONBILL_ASSERT(rate_numerator > 0 && rate_denominator > 0);
  // ffmpeg takes the format from the ending, which must therefore stay last.
  std::filesystem::path unfinished = file;
  unfinished.replace_filename(file.stem().string() + ".unfinished" + file.extension().string());
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return Error{std::string("no pipe to ffmpeg: ") + std::strerror(errno)};
  const pid_t process =
      start_process(ffmpeg_arguments(unfinished, std::to_string(width_px) + "x" + std::to_string(height_px),
                                     std::to_string(rate_numerator) + "/" + std::to_string(rate_denominator)),
                    ends[0], -1);
  close(ends[0]);
  if (process < 0) {
    close(ends[1]);
    return Error{"ffmpeg does not start; install ffmpeg or leave --video out"};
  }
  return VideoEncoder(file, std::move(unfinished), process, ends[1]);
}

VideoEncoder::VideoEncoder(VideoEncoder&& other) noexcept
    : file_(std::move(other.file_)),
      unfinished_(std::move(other.unfinished_)),
      process_(std::exchange(other.process_, -1)),
      pipe_(std::exchange(other.pipe_, -1)) {}

VideoEncoder::~VideoEncoder() {
  if (process_ < 0) return;
  close_and_wait();
  std::error_code ignored;
  std::filesystem::remove(unfinished_, ignored);
}

int VideoEncoder::close_and_wait() {
  if (pipe_ >= 0) close(std::exchange(pipe_, -1));
  const int state = wait_for_process(std::exchange(process_, -1));
  return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

Status VideoEncoder::add(const Image& frame) {
  std::size_t sent = 0;
  while (sent < frame.rgba.size()) {
    const ssize_t count = write(pipe_, frame.rgba.data() + sent, frame.rgba.size() - sent);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      return Error{file_.string() + ": ffmpeg stopped; is the folder writable and the ending known?"};
    }
    sent += static_cast<std::size_t>(count);
  }
  return {};
}

Status VideoEncoder::finish() {
  std::error_code ignored;
  if (const int code = close_and_wait(); code != 0) {
    std::filesystem::remove(unfinished_, ignored);
    return Error{file_.string() + ": ffmpeg failed with exit code " + std::to_string(code) +
                 "; is the folder writable and the ending known?"};
  }
  Status placed = publish_file(unfinished_, file_);
  if (!placed) std::filesystem::remove(unfinished_, ignored);
  return placed;
}

}  // namespace spoonbill
