// What the operating system grants a thread that must keep its times.
#pragma once

#include <pthread.h>

#include <string>

namespace spoonbill {

struct RealTimeGrant {
  bool fifo = false;
  bool memory_locked = false;
  std::string notice;  // what was not permitted and what permits it; empty where nothing was refused
};

// First-in-first-out scheduling at priority 80, or as near to it as permitted, for the thread, and the
// process's memory locked.
RealTimeGrant grant_real_time(pthread_t thread);

// Unlocks what grant_real_time() locked.
void give_back(const RealTimeGrant& grant);

// Writes to the calling thread's stack once, so that no later call waits for its pages.
void touch_stack();

}  // namespace spoonbill
