// Child processes: starts programs with given pipes, and reads a child's output with limits on its memory and
// time.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

// Starts `arguments[0]`, searched in PATH unless it contains a slash. `input` becomes its standard input and
// `output` its standard output; a negative descriptor stands for /dev/null. Standard error always goes to
// /dev/null. The child inherits no other descriptor. Returns -1 if the program cannot be started.
pid_t start_process(const std::vector<std::string>& arguments, int input, int output);

// Starts a program that parses input which may be hostile. Works as start_process(), but the environment is
// empty except for the locale C. The system kills the child when the calling thread ends, so call this
// function in a thread that outlives the child.
pid_t start_reader(const std::vector<std::string>& arguments, int input, int output);

// Waits until the process ends. Returns its state as waitpid() does.
int wait_for_process(pid_t process);

// Describes how a child process ended.
struct ChildEnd {
  int exit_code = 0;         // valid when no signal ended the process
  int signal = 0;            // signal that ended the process; 0 for none
  bool out_of_time = false;  // true if killed at the deadline, or for exceeding its processor time
};

// The standard output of a child process with limited memory and time, started by start_reader(). All calls
// must come from one thread, which must outlive the object.
class ChildOutput {
 public:
  // Limit on the child's address space, in bytes.
  static constexpr std::size_t memory_limit = std::size_t{4} << 30;

  // Starts the child. `patience` limits both its wall-clock time and its processor time. `input` becomes its
  // standard input; a negative descriptor stands for /dev/null. Returns an error if no pipe can be created or
  // the program cannot be started.
  static Result<ChildOutput> start(const std::vector<std::string>& arguments,
                                   std::chrono::milliseconds patience, int input = -1);

  ChildOutput(ChildOutput&& other) noexcept;
  ChildOutput& operator=(ChildOutput&&) = delete;
  ~ChildOutput();  // kills a child that still runs

  // Reads exactly `bytes` bytes. While waiting, calls `gives_up` every 50 ms. Returns false if the output
  // ends earlier, the time is over, or `gives_up` returns true.
  bool read(void* to, std::size_t bytes, const std::function<bool()>& gives_up = {});

  // Waits for the child to end, and kills it when the time is over.
  ChildEnd wait();

 private:
  using Clock = std::chrono::steady_clock;
  ChildOutput(pid_t process, int pipe, Clock::time_point deadline)
      : process_(process), pipe_(pipe), deadline_(deadline) {}

  pid_t process_;  // -1 after the child has ended
  int pipe_;
  Clock::time_point deadline_;
};

}  // namespace spoonbill
