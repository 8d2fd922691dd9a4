// Another program, started with nothing of ours but the pipes that it is given.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace spoonbill {

// Starts `arguments[0]` (searched in PATH unless it has a slash) with `input` as its standard input and
// `output` as its standard output, /dev/null for a negative one, and its standard error to /dev/null; -1 when
// it does not start. The ends of pipes that it must not have need O_CLOEXEC.
pid_t start_process(const std::vector<std::string>& arguments, int input, int output);

// Waits for its end; the state as waitpid() gives it.
int wait_for_process(pid_t process);

}  // namespace spoonbill
