#include "app/child_process.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <pthread.h>
#include <sys/prctl.h>
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

// A sanitizer reserves more address space than any useful limit, and reads its options from the environment.
// A child in a sanitizer build therefore gets no memory limit and the whole environment.
#ifdef SPOONBILL_SANITIZED
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

constexpr int first_free_descriptor = STDERR_FILENO + 1;
// Number of descriptors to mark one by one on kernels older than 5.11, which lack CLOSE_RANGE_CLOEXEC.
constexpr int descriptors_limit = 65536;
constexpr int exit_not_started = 127;

// Everything that the child needs between fork and exec, where it must not allocate.
struct Start {
  char* const* arguments;
  char* const* environment;
  int input, output;
  int failure;       // write end of the pipe through which the child reports that exec failed
  bool with_parent;  // true if the child must end when its parent ends
  pid_t parent;
  sigset_t signals;  // signal mask of the parent
};

// Resets all signal handlers to the default. Handlers of the parent must not run in the child, which shares
// the parent's memory until exec. Ignored signals stay ignored.
void forget_handlers() {
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = SIG_DFL;
    sigaction(signal, &action, nullptr);
  }
}

// Makes exec close all descriptors except the three standard ones.
void inherit_no_descriptors() {
  if (close_range(first_free_descriptor, ~0U, CLOSE_RANGE_CLOEXEC) == 0) return;
  for (int descriptor = first_free_descriptor; descriptor < descriptors_limit; ++descriptor) {
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  }
}

// Returns a duplicate of the descriptor, or of /dev/null if it is negative. The duplicate is above the three
// standard descriptors, so that the following calls of dup2() do not close it.
int source(int descriptor, int mode) {
  if (descriptor < 0) descriptor = open("/dev/null", mode | O_CLOEXEC);
  return fcntl(descriptor, F_DUPFD_CLOEXEC, first_free_descriptor);
}

[[noreturn]] void become(const Start& start) {
  // The parent may have ended before this call of prctl(). The kernel then sends no signal, but getppid() has
  // changed.
  if (start.with_parent && (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != start.parent)) {
    _exit(exit_not_started);
  }
  forget_handlers();
  const int input = source(start.input, O_RDONLY), output = source(start.output, O_WRONLY),
            nowhere = source(-1, O_WRONLY);
  if (dup2(input, STDIN_FILENO) >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
      dup2(nowhere, STDERR_FILENO) >= 0) {
    inherit_no_descriptors();
    sigprocmask(SIG_SETMASK, &start.signals, nullptr);
    execvpe(start.arguments[0], start.arguments, start.environment);
  }
  const char failed = 1;
  const ssize_t told = write(start.failure, &failed, 1);
  _exit(told == 1 ? exit_not_started : exit_not_started + 1);
}

// Starts a child with vfork(), so that it shares the parent's memory until exec. After fork(), which copies
// the page tables, the haptic thread would have a page fault at each page that it writes.
pid_t spawn(const std::vector<std::string>& arguments, int input, int output, bool with_parent,
            char* const* environment) {
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  int failure[2];
  if (pipe2(failure, O_CLOEXEC) != 0) return -1;
  Start start{pointers.data(), environment, input, output, failure[1], with_parent, getpid(), {}};
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &start.signals);
  const pid_t process = vfork();
  if (process == 0) become(start);
  pthread_sigmask(SIG_SETMASK, &start.signals, nullptr);
  close(failure[1]);
  char failed = 0;
  ssize_t told = 0;
  while ((told = read(failure[0], &failed, 1)) < 0 && errno == EINTR) {
  }
  close(failure[0]);
  if (process < 0 || told == 0) return process;
  wait_for_process(process);
  return -1;
}

}  // namespace

pid_t start_process(const std::vector<std::string>& arguments, int input, int output) {
  return spawn(arguments, input, output, false, environ);
}

pid_t start_reader(const std::vector<std::string>& arguments, int input, int output) {
  // The child gets only this variable. Others, such as OpenCASCADE's CSF_ variables, can change the behaviour
  // of libraries.
  char locale[] = "LC_ALL=C";
  char* const clean[] = {locale, nullptr};
  return spawn(arguments, input, output, true, is_sanitized ? environ : clean);
}

int wait_for_process(pid_t process) {
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) {
  }
  return state;
}

namespace {

constexpr std::int64_t poll_interval_ms = 50;

void limit(pid_t process, std::chrono::milliseconds patience) {
  const rlimit memory{ChildOutput::memory_limit, ChildOutput::memory_limit};
  if (!is_sanitized) prlimit(process, RLIMIT_AS, &memory, nullptr);
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
  const pid_t process = start_reader(arguments, input, ends[1]);
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
