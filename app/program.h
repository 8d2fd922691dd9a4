// The program behind the command line: all options are read before anything is done.
#pragma once

#include <string>
#include <vector>

#include "app/console.h"
#include "app/version.h"

namespace spoonbill {

inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;     // the work could not be done; one line on `err` says why
inline constexpr int exit_wrong_use = 2;  // the arguments make no sense; one line on `err` says which

// `arguments` without the program's name; `version` is what --version prints. Throws only what the standard
// library throws (memory).
int run_program(const std::vector<std::string>& arguments, Console& console,
                const std::string& version = version_number);

}  // namespace spoonbill
