// List of the files that this process has begun but not finished. When a signal ends the process, these files
// are removed or completed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace spoonbill {

// An entry in the process's list of unfinished files. The entry exists as long as this object. The list is
// global, because a signal ends the whole process. Objects may be used on any thread except the haptic
// thread.
class UnfinishedFile {
 public:
  // Function that removes or completes the file when the process stops early, and returns one line for the
  // user or an empty text. It may be called while another thread is writing the file.
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

// Removes or completes every unfinished file and returns the lines for the user. Afterwards the process must
// end, because every thread that then adds or removes a list entry blocks forever.
std::vector<std::string> end_unfinished_files();

}  // namespace spoonbill
