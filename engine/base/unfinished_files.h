// The files that this process has begun and not finished, for the moment when a signal ends it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace spoonbill {

// An entry in the process's list of unfinished files, which lasts as long as the object. The list belongs to
// the process, because a signal does. Thread-safe; never made on the haptic thread.
class UnfinishedFile {
 public:
  // Ends the file when the process stops early, from another thread than the file's own: removes or completes
  // it. Returns one line for the user, or nothing.
  using Ending = std::function<std::string()>;

  UnfinishedFile() = default;                           // no entry
  explicit UnfinishedFile(std::filesystem::path file);  // will be removed
  explicit UnfinishedFile(Ending ending);
  UnfinishedFile(UnfinishedFile&& other) noexcept;
  UnfinishedFile& operator=(UnfinishedFile&& other) noexcept;
  ~UnfinishedFile();

 private:
  std::uint64_t number_ = 0;  // 0 without an entry
};

// Ends every unfinished file and returns the lines for the user. The process must end afterwards: an
// unfinished file that another thread begins or finishes now waits for ever.
std::vector<std::string> end_unfinished_files();

}  // namespace spoonbill
