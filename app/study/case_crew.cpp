#include "app/study/case_crew.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Runs a case. A fault of the program, such as a failed assertion, ends one case instead of the study.
Result<CaseResult> run_safely(const StudyPlan& plan, const StudyCase& study_case, const CaseWatch& watch) {
  try {
    return run_case(plan, study_case, watch);
  } catch (const std::exception& fault) {
    CaseResult result;
    result.failure = std::string("a fault of the program: ") + fault.what();
    return result;
  }
}

// Returns the places of cases in groups that have the same result, because the spoons have one shape.
std::vector<std::vector<std::size_t>> group_equal_cases(const StudyPlan& plan,
                                                        const std::vector<StudyCase>& cases) {
  std::vector<std::vector<std::size_t>> groups;
  std::map<std::string, std::size_t> group_of;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    StudyCase common = cases[k];
    common.spoon = find_first_of_shape(plan, common.spoon);
    const auto [found, is_new] = group_of.emplace(case_key(common), groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(k);
  }
  return groups;
}

}  // namespace

Status run_cases(const StudyPlan& plan, const std::vector<StudyCase>& cases, int workers,
                 const CaseReceiver& receive, const std::function<bool()>& is_stopped) {
  SPOONBILL_ASSERT(workers >= 1);
  const std::vector<std::vector<std::size_t>> groups = group_equal_cases(plan, cases);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;  // guards `ended`
  std::condition_variable changed;
  std::deque<std::pair<std::size_t, Result<CaseResult>>> ended;
  const auto work = [&] {
    const CaseWatch watch = [&](const Trial&, const Simulation&) { return !stopped.load(); };
    for (std::size_t k = next++; k < groups.size() && !stopped.load(); k = next++) {
      auto result = run_safely(plan, cases[groups[k].front()], watch);
      const std::lock_guard lock(mutex);
      ended.emplace_back(k, std::move(result));
      changed.notify_one();
    }
  };
  const std::size_t count = std::min(static_cast<std::size_t>(workers), groups.size());
  std::vector<std::jthread> threads;
  for (std::size_t k = 0; k < count; ++k) threads.emplace_back(work);
  Status status;
  for (std::size_t received = 0; received < groups.size() && status.ok();) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::milliseconds(100), [&] { return !ended.empty(); });
    if (is_stopped()) {
      status = Error{ErrorCode::cancelled, "stopped"};
    } else if (!ended.empty()) {
      const auto [at, result] = std::move(ended.front());
      ended.pop_front();
      lock.unlock();
      ++received;
      status = result ? Status() : Status(result.error());
      for (const std::size_t equal : groups[at]) {
        if (status) status = receive(cases[equal], result.value());
      }
    }
  }
  stopped = !status.ok();
  threads.clear();  // waits for all of them
  return status;
}

}  // namespace spoonbill
