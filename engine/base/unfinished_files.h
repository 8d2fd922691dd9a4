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
  // Function that removes or completes the file when the process stops early, and returns one line for the
  // user or an empty text. It is called on a thread other than the file's own.
  using Ending = std::function<std::string()>;

  UnfinishedFile() = default;                           // makes an object without an entry
  explicit UnfinishedFile(std::filesystem::path file);  // the file will be removed if the process stops early
  explicit UnfinishedFile(Ending ending);
  UnfinishedFile(UnfinishedFile&& other) noexcept;
  UnfinishedFile& operator=(UnfinishedFile&& other) noexcept;
  ~UnfinishedFile();

 private:
  std::uint64_t number_ = 0;  // number of the entry; 0 for an object without one
};

// Ends every unfinished file and returns the lines for the user. Afterwards the process must end, because any
// thread that begins or finishes an unfinished file then blocks forever.
std::vector<std::string> end_unfinished_files();

}  // namespace spoonbill
