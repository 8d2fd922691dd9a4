// Where the program keeps what is not the person's own files: autosaved documents.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

// $XDG_STATE_HOME/spoonbill, or ~/.local/state/spoonbill (XDG Base Directory Specification 0.8), made when it
// is missing. Refused: neither variable set, a folder that cannot be made.
Result<std::filesystem::path> state_folder();

}  // namespace spoonbill
