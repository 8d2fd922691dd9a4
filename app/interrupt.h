// Ctrl+C, asked for instead of suffered: while one of these lives, SIGINT waits until the work reaches a
// place where it can stop. Make it before other threads start; they inherit the waiting. SIGTERM still ends
// the process at once.
#pragma once

#include <csignal>

namespace spoonbill {

class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();  // a signal that waits is dealt with then
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool requested() const;

  // The signal has been answered: the process lives on to report it.
  void answer();

 private:
  sigset_t watched_;
  sigset_t before_;
};

}  // namespace spoonbill
