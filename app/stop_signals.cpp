#include "app/stop_signals.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "engine/base/unfinished_files.h"

namespace spoonbill {
namespace {

// Time in which a command may end by itself after a signal. Short enough for the process to end within a
// second, even on a busy machine.
constexpr std::chrono::milliseconds patience{600};

std::atomic<bool> stop_signal_arrived{false};

void print_line(const std::string& text) {
  const std::string line = "spoonbill: " + text + "\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
}

void wait_for_stop_signal(const sigset_t& watched) {
  int number = 0;
  while (sigwait(&watched, &number) != 0) {
  }
  stop_signal_arrived.store(true);
  std::this_thread::sleep_for(patience);
  std::string text = "stopped by a signal";
  for (const std::string& line : end_unfinished_files()) text += "; " + line;
  print_line(text);
  // The process ends by the default effect of the signal, so that the caller sees which signal ended it.
  std::signal(number, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  raise(number);
  _exit(128 + number);
}

}  // namespace

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (sigaction(number, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&signals, number);
  }
  return signals;
}

void watch_stop_signals() {
  const sigset_t watched = stop_signals();
  pthread_sigmask(SIG_BLOCK, &watched, nullptr);
  std::thread([watched] { wait_for_stop_signal(watched); }).detach();
}

bool has_stop_signal() {
  return stop_signal_arrived.load();
}

}  // namespace spoonbill
