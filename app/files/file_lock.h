// A lock between processes, by a file. Gone with the process that holds it, however that ends.
#pragma once

#include <filesystem>
#include <optional>

namespace spoonbill {

// Held while it lives; its file goes with it. One owner; any thread.
class FileLock {
 public:
  // Nothing where another holds it, in this process or another, or where the file cannot be made.
  static std::optional<FileLock> take(const std::filesystem::path& file);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

 private:
  FileLock(std::filesystem::path file, int descriptor);
  void release();

  std::filesystem::path file_;
  int descriptor_ = -1;  // below 0: none
};

}  // namespace spoonbill
