// List of the files that this process has begun but not finished, so that they can be removed or completed
// when a signal ends the process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace spoonbill {

// An entry in the process's list of unfinished files. The entry exists as long as this object. The list is
// global, because a signal ends the whole process. Thread-safe; never constructed on the haptic thread.
class UnfinishedFile {
 public:
  // Removes or completes the file when the process stops early; called on a thread other than the file's own.
  // Returns one line for the user, or an empty text.
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

// Ends every unfinished file and returns the lines for the user. Afterwards the process must end, because any
// thread that begins or finishes an unfinished file then blocks forever.
std::vector<std::string> end_unfinished_files();

}  // namespace spoonbill
