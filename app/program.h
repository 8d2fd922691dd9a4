// The program as a function: parses the command line completely, then runs one command.
#pragma once

#include <string>
#include <vector>

#include "app/console.h"
#include "app/version.h"

namespace spoonbill {

inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;     // the command failed; one line on `err` says why
inline constexpr int exit_wrong_use = 2;  // invalid arguments; one line on `err` names the first one

// Runs the command that the arguments name and returns the process's exit code. `arguments` excludes the
// program's name; `version` is what --version prints. Throws only standard exceptions, such as
// std::bad_alloc.
int run_program(const std::vector<std::string>& arguments, Console& console,
                const std::string& version = version_number);

}  // namespace spoonbill
