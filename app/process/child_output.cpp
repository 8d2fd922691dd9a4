#include "app/process/child_output.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <thread>
#include <utility>

#include "app/process/child_process.h"

namespace spoonbill {
namespace {

// A sanitizer's own memory takes up more addresses than any limit allows.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool addresses_are_limited = false;
#else
constexpr bool addresses_are_limited = true;
#endif

constexpr std::int64_t milliseconds_between_questions = 50;

void limit(pid_t process, std::chrono::milliseconds patience) {
  const rlimit memory{ChildOutput::memory_limit, ChildOutput::memory_limit};
  if (addresses_are_limited) prlimit(process, RLIMIT_AS, &memory, nullptr);
  const auto whole = static_cast<rlim_t>(std::chrono::ceil<std::chrono::seconds>(patience).count());
  const rlimit seconds{whole, whole + 1}, nothing{0, 0};
  prlimit(process, RLIMIT_CPU, &seconds, nullptr);
  prlimit(process, RLIMIT_CORE, &nothing, nullptr);
  prlimit(process, RLIMIT_FSIZE, &nothing, nullptr);
}

}  // namespace

Result<ChildOutput> ChildOutput::start(const std::vector<std::string>& arguments,
                                       std::chrono::milliseconds patience, int input) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return Error{"there is no pipe left to read it through"};
  const pid_t process = start_process(arguments, input, ends[1]);
  close(ends[1]);
  if (process < 0) {
    close(ends[0]);
    return Error{arguments[0] + " does not start, which reads it"};
  }
  limit(process, patience);
  return ChildOutput(process, ends[0], Clock::now() + patience);
}

ChildOutput::ChildOutput(ChildOutput&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      pipe_(std::exchange(other.pipe_, -1)),
      deadline_(other.deadline_) {}

ChildOutput::~ChildOutput() {
  if (pipe_ >= 0) close(pipe_);
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  wait_for_process(process_);
}

bool ChildOutput::read(void* to, std::size_t bytes, const std::function<bool()>& gives_up) {
  auto* place = static_cast<char*>(to);
  while (bytes > 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
    pollfd waiting{pipe_, POLLIN, 0};
    if (gives_up && gives_up()) return false;
    const auto wait = gives_up ? std::min<std::int64_t>(left, milliseconds_between_questions) : left;
    const int ready = wait > 0 ? poll(&waiting, 1, static_cast<int>(wait)) : 0;
    if ((ready < 0 && errno == EINTR) || (ready == 0 && wait < left)) continue;
    if (ready <= 0) return false;
    const ssize_t count = ::read(pipe_, place, bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    place += count;
    bytes -= static_cast<std::size_t>(count);
  }
  return true;
}

ChildEnd ChildOutput::wait() {
  int state = 0;
  pid_t ended = 0;
  while ((ended = waitpid(process_, &state, WNOHANG)) == 0 && Clock::now() < deadline_) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ChildEnd end;
  if (ended == 0) {
    kill(process_, SIGKILL);
    state = wait_for_process(process_);
    end.out_of_time = true;
  }
  process_ = -1;
  if (WIFEXITED(state)) end.exit_code = WEXITSTATUS(state);
  if (WIFSIGNALED(state)) end.signal = WTERMSIG(state);
  end.out_of_time = end.out_of_time || end.signal == SIGXCPU;
  return end;
}

}  // namespace spoonbill
