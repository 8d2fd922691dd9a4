// The built program as a process of its own, for what only a process can show.
#pragma once

#include <string>

#include "tests/app/workplace.h"

namespace spoonbill {

// `settings` are put before the program in the shell ("LP_NUM_THREADS=1"); arguments are quoted for it.
Outcome run_process(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& settings = "");

// Starts the program, kills it with SIGKILL once the file has grown beyond `bytes`, and waits for its end.
void run_and_kill(const std::string& program, const std::vector<std::string>& arguments,
                  const std::filesystem::path& file, std::uintmax_t bytes);

}  // namespace spoonbill
