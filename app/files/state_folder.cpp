#include "app/files/state_folder.h"

#include <cstdlib>
#include <system_error>

namespace spoonbill {

Result<std::filesystem::path> state_folder() {
  std::filesystem::path base;
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && state[0] == '/') {
    base = state;
  } else if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/') {
    base = std::filesystem::path(home) / ".local" / "state";
  } else {
    return Error{"no place to autosave: set HOME or XDG_STATE_HOME to a folder"};
  }
  std::filesystem::path folder = base / "spoonbill";
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) return Error{folder.string() + ": cannot be made, " + problem.message()};
  return folder;
}

}  // namespace spoonbill
