#include "app/files/state_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

namespace spoonbill {
namespace {

// Returns true if the name still refers to the opened file. The previous holder of the lock may have deleted
// the file between open() and flock().
bool is_still_named(int descriptor, const std::filesystem::path& file) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(file.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

}  // namespace

Result<std::filesystem::path> state_folder() {
  std::filesystem::path base;
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && state[0] == '/') {
    base = state;
  } else if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/') {
    base = std::filesystem::path(home) / ".local" / "state";
  } else {
    return Error{ErrorCode::unavailable, "no folder for autosaves: set HOME or XDG_STATE_HOME to a folder"};
  }
  std::filesystem::path folder = base / "spoonbill";
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) {
    return Error{ErrorCode::unwritable, folder.string() + ": cannot be created: " + problem.message()};
  }
  return folder;
}

Result<FileLock> FileLock::acquire(const std::filesystem::path& file) {
  while (true) {
    const int descriptor = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor < 0) return Error{ErrorCode::unwritable, file.string() + ": cannot be created"};
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const bool is_held = errno == EWOULDBLOCK;
      close(descriptor);
      if (is_held) return Error{ErrorCode::in_use, file.string() + ": is locked by another program"};
      return Error{ErrorCode::unwritable, file.string() + ": cannot be locked"};
    }
    if (is_still_named(descriptor, file)) return FileLock(file, descriptor);
    close(descriptor);
  }
}

FileLock::FileLock(std::filesystem::path file, int descriptor)
    : file_(std::move(file)), descriptor_(descriptor) {}

FileLock::FileLock(FileLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  if (this == &other) return *this;
  release();
  file_ = std::move(other.file_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  return *this;
}

FileLock::~FileLock() {
  release();
}

void FileLock::release() {
  if (descriptor_ < 0) return;
  unlink(file_.c_str());
  close(descriptor_);
  descriptor_ = -1;
}

}  // namespace spoonbill
