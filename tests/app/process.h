// Runs the built program as a separate process.
#pragma once

#include <string>

#include "tests/app/workplace.h"

namespace spoonbill {

// Runs the program and waits for its end. `settings` are environment variables, such as "LP_NUM_THREADS=1".
// Arguments are quoted for the shell.
Outcome run_process(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& settings = "");

// Starts the program, kills it with SIGKILL once the file has grown beyond `bytes`, and waits for its end.
void run_and_kill(const std::string& program, const std::vector<std::string>& arguments,
                  const std::filesystem::path& file, std::uintmax_t bytes);

}  // namespace spoonbill
