#include "haptic/real_time.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstddef>

namespace spoonbill {

namespace {

// Above ordinary threads and most interrupt threads' users, below the kernel's own at 99.
constexpr int wanted_priority = 80;

// More than a tick uses; the deepest call of the simulation stays far below.
constexpr std::size_t touched_stack_bytes = std::size_t{256} << 10;
constexpr std::size_t page_bytes = 4096;

bool set_priority(pthread_t thread, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(thread, SCHED_FIFO, &parameters) == 0;
}

bool make_fifo(pthread_t thread) {
  if (set_priority(thread, wanted_priority)) return true;
  rlimit permitted{};
  if (getrlimit(RLIMIT_RTPRIO, &permitted) != 0 || permitted.rlim_cur == 0) return false;
  return set_priority(thread, static_cast<int>(std::min<rlim_t>(permitted.rlim_cur, wanted_priority)));
}

std::string notice_of(const RealTimeGrant& grant) {
  std::string refused, lines, asked_by;
  if (!grant.fifo) {
    refused = "real-time scheduling";
    lines = "\"USER - rtprio 80\"";
    asked_by = "ulimit -r";
  }
  if (!grant.memory_locked) {
    refused += (refused.empty() ? "" : " and ") + std::string("locked memory");
    lines += (lines.empty() ? "" : " and ") + std::string("\"USER - memlock unlimited\"");
    asked_by += (asked_by.empty() ? "" : ", ") + std::string("ulimit -l");
  }
  if (refused.empty()) return {};
  return "the system does not permit " + refused + " (" + asked_by +
         "); the rate shown is the one held; to permit it add " + lines +
         " to /etc/security/limits.conf and log in anew";
}

}  // namespace

RealTimeGrant grant_real_time(pthread_t thread) {
  RealTimeGrant grant;
  grant.fifo = make_fifo(thread);
  // Not MCL_FUTURE, which makes every later allocation fail once the limit is met. On fault, so that what
  // is mapped and never used, such as the stacks of other threads, takes no memory.
  grant.memory_locked = mlockall(MCL_CURRENT | MCL_ONFAULT) == 0;
  grant.notice = notice_of(grant);
  return grant;
}

void give_back(const RealTimeGrant& grant) {
  if (grant.memory_locked) munlockall();
}

[[gnu::noinline]] void touch_stack() {
  std::byte stack[touched_stack_bytes];
  volatile std::byte* const pages = stack;
  for (std::size_t byte = 0; byte < touched_stack_bytes; byte += page_bytes) pages[byte] = std::byte{0};
}

}  // namespace spoonbill
