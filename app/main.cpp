#include <unistd.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "app/program.h"
#include "app/stop_signals.h"
#include "app/version.h"
#include "engine/base/assert.h"

int main(int argc, char** argv) {
  // A closed pipe and a file above the user's size limit must not end the process: writing fails, and the
  // failure is reported.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  spoonbill::watch_stop_signals();
  // A failed assertion abandons the job in progress (a tick, a save, this command), not the process.
  spoonbill::set_assertion_handler(spoonbill::throw_failed_assertion);
  try {
    const std::vector<std::string> arguments(argv + (argc > 0 ? 1 : 0), argv + argc);
    spoonbill::Console console{std::cout, std::cerr, isatty(STDERR_FILENO) != 0};
    return spoonbill::run_program(arguments, console, spoonbill::version_with_commit());
  } catch (const std::exception& exception) {
    std::cerr << "spoonbill: " << spoonbill::one_line(exception.what()) << '\n';
    return spoonbill::exit_failed;
  }
}
