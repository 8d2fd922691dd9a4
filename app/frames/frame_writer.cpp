#include "app/frames/frame_writer.h"

#include <unistd.h>

#include <cstdio>
#include <string>
#include <system_error>
#include <vector>

#include "render/image.h"

namespace spoonbill {
namespace {

// Two frames to even out the drawing's pace; more would only hold memory.
constexpr std::size_t queue_limit = 3;

bool is_of_earlier_run(const std::string& name) {
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

Status prepare_frame_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{folder.string() + ": the folder cannot be made: " + error.message()};
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    return Error{folder.string() +
                 ": the folder cannot be written to: " + std::generic_category().message(errno)};
  }
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_of_earlier_run(entry.path().filename().string())) old.push_back(entry.path());
  }
  for (const fs::path& file : old) {
    if (!error) fs::remove(file, error);
  }
  if (error) return Error{folder.string() + ": old frames cannot be removed: " + error.message()};
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
    const Status written =
        write_png(folder_ / frame_file_name(frame.first), frame.second, encoder, Durability::later);
    if (!written) {
      const std::lock_guard lock(mutex_);
      failure_ = written;
      changed_.notify_all();
      return;
    }
  }
}

}  // namespace spoonbill
