#include "app/frames/replay_pictures.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/child_process.h"
#include "app/panel/interface_context.h"
#include "app/session/lockstep.h"
#include "engine/base/assert.h"
#include "engine/base/file.h"
#include "render/image.h"

namespace spoonbill {

Result<std::vector<std::string>> consume_marks(Session& session,
                                               const std::optional<std::filesystem::path>& folder) {
  const std::vector<FileMark> marks = std::exchange(session.marks, {});
  std::vector<std::string> pictures;
  if (!folder) return pictures;
  for (const FileMark& mark : marks) {
    if (!mark.document) {
      pictures.push_back(mark.mark.name);
      continue;
    }
    const std::filesystem::path file = *folder / ("saved-" + mark.mark.name + ".json");
    if (Status written = write_document(*mark.document, file, {NamedBy::program}); !written)
      return written.error();
  }
  return pictures;
}

Status write_marked_picture(const Image& picture, const std::string& name,
                            const std::filesystem::path& folder) {
  return write_png(folder / ("picture-" + name + ".png"), picture, {NamedBy::program});
}

namespace {

// Largest number of queued frames: enough to even out the pace of drawing without holding much memory.
constexpr std::size_t queue_limit = 3;

bool is_output_of_earlier_run(const std::string& name) {
  if (name == "contact-sheet.png") return true;
  constexpr std::string_view start = "frame-";
  constexpr std::string_view end = ".png";
  if (!name.starts_with(start) || !name.ends_with(end)) return false;
  const std::string number = name.substr(start.size(), name.size() - start.size() - end.size());
  return !number.empty() && number.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::string frame_file_name(int number) {
  char name[32];
  std::snprintf(name, sizeof(name), "frame-%04d.png", number);
  return name;
}

Status prepare_frame_folder(const std::filesystem::path& folder, bool replaces_read_only) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return Error{ErrorCode::unwritable, folder.string() + ": cannot create the folder: " + error.message()};
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return Error{ErrorCode::unwritable,
                 folder.string() + ": cannot write to the folder: " + std::generic_category().message(errno)};
  }
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_output_of_earlier_run(entry.path().filename().string())) old.push_back(entry.path());
  }
  for (const fs::path& file : old) {
    // The link itself is removed, so the permissions of its target do not matter.
    if (replaces_read_only || fs::is_symlink(fs::symlink_status(file, error))) continue;
    if (Status checked = check_replaceable(file); !checked) return checked;
  }
  for (const fs::path& file : old) {
    if (!error) fs::remove(file, error);
  }
  if (error) {
    return Error{ErrorCode::unwritable, folder.string() + ": cannot remove old frames: " + error.message()};
  }
  return {};
}

FrameWriter::FrameWriter(std::filesystem::path folder)
    : folder_(std::move(folder)), thread_([this] { write_frames(); }) {}

FrameWriter::~FrameWriter() {
  [[maybe_unused]] const Status finished = finish();
}

Status FrameWriter::add(int number, Image frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return queue_.size() < queue_limit || !failure_; });
  if (!failure_) return failure_;
  queue_.emplace_back(number, std::move(frame));
  changed_.notify_all();
  return {};
}

Status FrameWriter::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
    changed_.notify_all();
  }
  if (!thread_.joinable()) return failure_;
  thread_.join();
  return failure_ ? flush_to_disk(folder_) : failure_;
}

void FrameWriter::write_frames() {
  PngEncoder encoder;
  while (true) {
    std::pair<int, Image> frame;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return !queue_.empty() || finishing_; });
      if (queue_.empty()) return;
      frame = std::move(queue_.front());
      queue_.pop_front();
      changed_.notify_all();
    }
    const Status written = write_png(folder_ / frame_file_name(frame.first), frame.second, encoder,
                                     Durability::later, {NamedBy::program});
    if (!written) {
      const std::lock_guard lock(mutex_);
      failure_ = written;
      changed_.notify_all();
      return;
    }
  }
}

namespace {

std::vector<std::string> ffmpeg_arguments(const std::filesystem::path& file, const std::string& size,
                                          const std::string& rate) {
  // The filter pads the picture to even width and height, which most players need.
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

// `unfinished` is the file that ffmpeg writes; it is renamed to `target` at the end. For a pipe or a device,
// both are the same.
struct VideoPlace {
  std::filesystem::path unfinished, target;
};

// Makes the empty file that ffmpeg will fill. It gets the permissions of an existing video that it will
// replace. It is created exclusively, so that a link with its name is not followed. For a pipe or a device,
// makes no file.
Result<VideoPlace> prepare_video(const std::filesystem::path& file) {
  VideoPlace place{file, file};
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  const bool replaces = std::filesystem::is_regular_file(status);
  if (std::filesystem::exists(status) && !replaces) return place;
  if (replaces) place.target = std::filesystem::canonical(file, ignored);
  if (place.target.empty()) place.target = file;
  // ffmpeg derives the format from the extension, which must therefore remain last.
  place.unfinished = place.target;
  place.unfinished.replace_filename(place.target.stem().string() + ".unfinished-" + std::to_string(getpid()) +
                                    place.target.extension().string());
  ::unlink(place.unfinished.c_str());
  const int descriptor =
      ::open(place.unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return Error{ErrorCode::unwritable,
                 file.string() + ": cannot be written: " + std::generic_category().message(errno), "video"};
  }
  if (replaces) ::fchmod(descriptor, static_cast<mode_t>(status.permissions()) & 0777);
  ::close(descriptor);
  return place;
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
  auto place = prepare_video(file);
  if (!place) return place.error();
  const std::filesystem::path& unfinished = place->unfinished;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return Error{ErrorCode::unavailable, std::string("no pipe to ffmpeg: ") + std::strerror(errno)};
  }
  const pid_t process =
      start_process(ffmpeg_arguments(unfinished, std::to_string(width_px) + "x" + std::to_string(height_px),
                                     std::to_string(rate_numerator) + "/" + std::to_string(rate_denominator)),
                    ends[0], -1);
  close(ends[0]);
  if (process < 0) {
    close(ends[1]);
    if (unfinished != place->target) std::filesystem::remove(unfinished);
    return Error{ErrorCode::unavailable, "ffmpeg does not start: install ffmpeg or omit --video", "video"};
  }
  return VideoEncoder(place->target, unfinished, process, ends[1]);
}

VideoEncoder::VideoEncoder(std::filesystem::path file, std::filesystem::path unfinished, pid_t process,
                           int pipe)
    : file_(std::move(file)),
      unfinished_(std::move(unfinished)),
      process_(process),
      pipe_(pipe),
      ending_([process, beside = file_ == unfinished_ ? std::filesystem::path() : unfinished_] {
        kill(process, SIGKILL);
        if (!beside.empty()) ::unlink(beside.c_str());
        return std::string();
      }) {}

VideoEncoder::VideoEncoder(VideoEncoder&& other) noexcept
    : file_(std::move(other.file_)),
      unfinished_(std::move(other.unfinished_)),
      process_(std::exchange(other.process_, -1)),
      pipe_(std::exchange(other.pipe_, -1)),
      ending_(std::move(other.ending_)) {}

VideoEncoder::~VideoEncoder() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);  // the unfinished video is removed, so encoding the rest is useless
  close_and_wait();
  remove_unfinished();
}

void VideoEncoder::remove_unfinished() {
  std::error_code ignored;
  if (unfinished_ != file_) std::filesystem::remove(unfinished_, ignored);
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
      return Error{
          ErrorCode::process_failed,
          file_.string() +
              ": ffmpeg stopped: check that the folder is writable and that ffmpeg knows the extension"};
    }
    sent += static_cast<std::size_t>(count);
  }
  return {};
}

Status VideoEncoder::finish() {
  if (const int code = close_and_wait(); code != 0) {
    remove_unfinished();
    return Error{ErrorCode::process_failed,
                 file_.string() + ": ffmpeg failed with exit code " + std::to_string(code) +
                     ": check that the folder is writable and that ffmpeg knows the extension"};
  }
  if (unfinished_ == file_) return {};
  Status published = publish_file(unfinished_, file_);
  if (!published) remove_unfinished();
  return published;
}

namespace {

ContactSheetLayout sheet_layout() {
  ContactSheetLayout layout;
  layout.columns = 3;
  layout.cell_width_px = 480;
  layout.caption_px = 20;
  layout.caption_font_path = font_file;
  return layout;
}

}  // namespace

Result<ReplayPictures> ReplayPictures::start(const PictureRequest& request) {
  if (request.folder) {
    if (Status prepared = prepare_frame_folder(*request.folder, request.replaces_read_only); !prepared)
      return prepared.error();
  }
  std::optional<VideoEncoder> video;
  if (request.video) {
    auto started = VideoEncoder::start(*request.video, request.size.width_px, request.size.height_px,
                                       static_cast<int>(frames_per_second), static_cast<int>(request.every));
    if (!started) return started.error();
    video.emplace(std::move(started).value());
  }
  return ReplayPictures(request, std::move(video));
}

ReplayPictures::ReplayPictures(PictureRequest request, std::optional<VideoEncoder> video)
    : request_(std::move(request)), video_(std::move(video)), sheet_(sheet_layout()) {
  if (request_.folder) frames_ = std::make_unique<FrameWriter>(*request_.folder);
}

Status ReplayPictures::add(std::uint64_t frame, Image picture) {
  if (video_) {
    if (Status added = video_->add(picture); !added) return added;
  }
  if (frames_) {
    for (const SheetFrame& each : sheet_frames_) {
      if (each.frame == frame) sheet_.add(picture, each.caption);
    }
    if (Status added = frames_->add(static_cast<int>(frame), std::move(picture)); !added) return added;
  }
  ++count_;
  return {};
}

Status ReplayPictures::finish() {
  if (video_) {
    if (Status finished = video_->finish(); !finished) return finished;
  }
  if (!frames_) return {};
  if (Status finished = frames_->finish(); !finished) return finished;
  const auto sheet = sheet_.compose();
  if (!sheet) return sheet.error();
  return write_png(contact_sheet_file(), sheet.value(), {NamedBy::program});
}

}  // namespace spoonbill
