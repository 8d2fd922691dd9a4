// The worker: does to a session what takes milliseconds and memory, on a thread that may wait, while the
// haptic thread goes on. At most one session is with it at a time.
#pragma once

#include <atomic>
#include <semaphore>
#include <thread>

#include "app/live/live_command.h"
#include "app/live/notices.h"

namespace spoonbill {

class SessionWorker {
 public:
  // The notices must outlive the worker; an error of the work becomes one.
  explicit SessionWorker(Notices& notices);
  ~SessionWorker();  // what it has is finished first

  // By the haptic thread, neither waits nor allocates. After lend(), nothing until take_back() has returned
  // true, which it does once for each loan; `work` is what was asked for, `done` tells whether it succeeded.
  void lend(LentSession lent, LiveCommand work);
  bool take_back(LentSession& lent, LiveCommand& work, bool& done);

 private:
  void run();

  Notices* notices_;
  LentSession lent_;
  LiveCommand work_;
  bool done_ = false;
  std::atomic<bool> finished_{false};
  std::atomic<bool> stopping_{false};
  std::counting_semaphore<2> asked_{0};  // a loan and the stop
  std::thread thread_;
};

}  // namespace spoonbill
