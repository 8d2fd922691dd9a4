// The folder of autosaved documents, and locks that keep two processes from using the same file there.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

// Returns $XDG_STATE_HOME/spoonbill or ~/.local/state/spoonbill (XDG Base Directory Specification 0.8) and
// creates it if it is missing.
Result<std::filesystem::path> state_folder();

// An exclusive lock between processes, held through a lock file that is deleted when the lock is released.
// The system releases the lock when the process ends, however it ends. The lock has one owner and may be used
// on any thread.
class FileLock {
 public:
  // Returns ErrorCode::in_use if this or another process holds the lock, ErrorCode::unwritable if the file
  // cannot be created or locked.
  static Result<FileLock> acquire(const std::filesystem::path& file);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

 private:
  FileLock(std::filesystem::path file, int descriptor);
  void release();

  std::filesystem::path file_;
  int descriptor_ = -1;  // descriptor of the lock file; -1 after a move
};

}  // namespace spoonbill
