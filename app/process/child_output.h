// What a child process of limited memory, time and patience writes to its standard output.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

struct ChildEnd {
  int exit_code = 0;         // where no signal ended it
  int signal = 0;            // 0 for none
  bool out_of_time = false;  // it was ended by us, or by the system for its processor time
};

// One owner, one thread.
class ChildOutput {
 public:
  static constexpr std::size_t memory_limit = std::size_t{4} << 30;  // of its addresses, in bytes

  // The patience is for all that it does, in time of the clock; its processor time is limited to the same.
  // `input` becomes its standard input, nothing if negative.
  static Result<ChildOutput> start(const std::vector<std::string>& arguments,
                                   std::chrono::milliseconds patience, int input = -1);

  ChildOutput(ChildOutput&& other) noexcept;
  ChildOutput& operator=(ChildOutput&&) = delete;
  ~ChildOutput();  // a child that still runs is killed

  // False when the output ends before so many bytes, or the patience does, or `gives_up`, which is asked
  // several times a second meanwhile, returns true.
  bool read(void* to, std::size_t bytes, const std::function<bool()>& gives_up = {});

  // Waits for its end until the patience is over, then kills it.
  ChildEnd wait();

 private:
  using Clock = std::chrono::steady_clock;
  ChildOutput(pid_t process, int pipe, Clock::time_point deadline)
      : process_(process), pipe_(pipe), deadline_(deadline) {}

  pid_t process_;  // -1 when it has ended
  int pipe_;
  Clock::time_point deadline_;
};

}  // namespace spoonbill
