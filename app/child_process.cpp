#include "app/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <thread>
#include <utility>

namespace spoonbill {
namespace {

void redirect(posix_spawn_file_actions_t& actions, int from, int as, int mode) {
  if (from >= 0) {
    posix_spawn_file_actions_adddup2(&actions, from, as);
  } else {
    posix_spawn_file_actions_addopen(&actions, as, "/dev/null", mode, 0);
  }
}

}  // namespace

pid_t start_process(const std::vector<std::string>& arguments, int input, int output) {
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  redirect(actions, input, STDIN_FILENO, O_RDONLY);
  redirect(actions, output, STDOUT_FILENO, O_WRONLY);
  redirect(actions, -1, STDERR_FILENO, O_WRONLY);
  pid_t process = -1;
  const int error = posix_spawnp(&process, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error == 0 ? process : -1;
}

int wait_for_process(pid_t process) {
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) {
  }
  return state;
}

namespace {

// Sanitizers reserve more address space than any limit allows.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool has_address_limit = false;
#else
constexpr bool has_address_limit = true;
#endif

constexpr std::int64_t poll_interval_ms = 50;

void limit(pid_t process, std::chrono::milliseconds patience) {
  const rlimit memory{ChildOutput::memory_limit, ChildOutput::memory_limit};
  if (has_address_limit) prlimit(process, RLIMIT_AS, &memory, nullptr);
  const auto whole_seconds = static_cast<rlim_t>(std::chrono::ceil<std::chrono::seconds>(patience).count());
  const rlimit seconds{whole_seconds, whole_seconds + 1}, nothing{0, 0};
  prlimit(process, RLIMIT_CPU, &seconds, nullptr);
  prlimit(process, RLIMIT_CORE, &nothing, nullptr);
  prlimit(process, RLIMIT_FSIZE, &nothing, nullptr);
}

}  // namespace

Result<ChildOutput> ChildOutput::start(const std::vector<std::string>& arguments,
                                       std::chrono::milliseconds patience, int input) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return Error{ErrorCode::unavailable, "cannot create a pipe to read the child process's output"};
  }
  const pid_t process = start_process(arguments, input, ends[1]);
  close(ends[1]);
  if (process < 0) {
    close(ends[0]);
    return Error{ErrorCode::unavailable, arguments[0] + " does not start: check the installation"};
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
  auto* destination = static_cast<char*>(to);
  while (bytes > 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
    pollfd waiting{pipe_, POLLIN, 0};
    if (gives_up && gives_up()) return false;
    const auto wait = gives_up ? std::min<std::int64_t>(left, poll_interval_ms) : left;
    const int ready = wait > 0 ? poll(&waiting, 1, static_cast<int>(wait)) : 0;
    if ((ready < 0 && errno == EINTR) || (ready == 0 && wait < left)) continue;
    if (ready <= 0) return false;
    const ssize_t count = ::read(pipe_, destination, bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    destination += count;
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
