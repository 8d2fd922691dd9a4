#include "app/session/task_comparison.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <thread>
#include <utility>

#include "app/session/lockstep.h"
#include "app/training/person_log.h"
#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// A run that is to be done, and its cell.
struct ComparisonJob {
  std::size_t cell = 0, run = 0;
  TrainingChoice choice;
};

Result<ComparedRun> run_script(const ComparisonPlan& plan, const TrainingChoice& choice,
                               const std::atomic<bool>& stopped) {
  auto setting = read_training_setting(choice);
  if (!setting) return setting.error();
  auto device = ScriptedDevice::make(plan.script);
  if (!device) return device.error();
  auto session = make_training_session(setting.value(), choice.task.string(), device->specification(),
                                       plan.instruction_set);
  if (!session) return session.error();
  LockstepInput input;
  input.device = &device.value();
  input.tick_count = plan.script.tick_count();
  input.source = "the script";
  Lockstep lockstep(session.value(), std::move(input), nullptr);
  constexpr std::uint64_t ticks_between_checks = 20;
  while (lockstep.tick() < lockstep.tick_count() && !session->watch->has_ended() && !stopped.load()) {
    if (Status ran = lockstep.run_to(std::min(lockstep.tick() + ticks_between_checks, lockstep.tick_count()));
        !ran) {
      return ran.error();
    }
  }
  ComparedRun run;
  run.seed = choice.seed;
  run.result = session->watch->result();
  run.score = run.result.score(setting->task);
  run.wrist_used = find_wrist_used(run.result, setting->hand);
  return run;
}

// A fault of the program ends one run instead of the comparison.
Result<ComparedRun> run_script_safely(const ComparisonPlan& plan, const TrainingChoice& choice,
                                      const std::atomic<bool>& stopped) {
  try {
    return run_script(plan, choice, stopped);
  } catch (const std::exception& fault) {
    return Error{ErrorCode::internal, std::string("a fault of the program: ") + fault.what()};
  }
}

bool trembles(const HandModel& hand) {
  return hand.tremor && (hand.tremor->amplitude_m > 0.0 || hand.tremor->turn_rad > 0.0);
}

}  // namespace

int ComparedCell::success_count() const {
  return static_cast<int>(std::count_if(
      runs.begin(), runs.end(), [](const ComparedRun& run) { return run.result.end == TaskEnd::success; }));
}

MeanOfRuns find_mean(const ComparedCell& cell, const std::function<double(const ComparedRun&)>& measure) {
  MeanOfRuns found;
  const auto count = static_cast<double>(cell.runs.size());
  if (cell.runs.empty()) return found;
  for (const ComparedRun& run : cell.runs) found.mean += measure(run) / count;
  double squares = 0.0;
  for (const ComparedRun& run : cell.runs) squares += std::pow(measure(run) - found.mean, 2);
  if (cell.runs.size() > 1) found.deviation = std::sqrt(squares / (count - 1.0));
  return found;
}

Range<double> find_rate_interval(int successes, int runs) {
  if (runs == 0) return {0.0, 1.0};
  constexpr double z = 1.959963984540054;  // of the normal distribution, for 95 %
  const double n = runs, rate = successes / n;
  const double centre = (rate + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(rate * (1.0 - rate) / n + z * z / (4.0 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

CellVerdict judge(const ComparedCell& cell) {
  if (!cell.failure.empty() || cell.runs.empty()) return CellVerdict::unusable;
  const int successes = cell.success_count();
  if (!cell.is_random) return successes > 0 ? CellVerdict::succeeds : CellVerdict::fails;
  const Range<double> rate = find_rate_interval(successes, static_cast<int>(cell.runs.size()));
  if (rate.low > 0.5) return CellVerdict::succeeds;
  return rate.high < 0.5 ? CellVerdict::fails : CellVerdict::undecided;
}

Result<std::vector<ComparedCell>> run_comparison(
    const ComparisonPlan& plan, int workers, const std::function<bool()>& is_stopped,
    const std::function<void(std::size_t, std::size_t)>& report) {
  SPOONBILL_ASSERT(workers >= 1 && plan.seeds >= 1);
  if (const auto task = read_task(plan.task); !task) return task.error();
  std::vector<ComparedCell> cells;
  std::vector<ComparisonJob> jobs;
  for (const std::filesystem::path& spoon : plan.spoons) {
    for (const std::filesystem::path& hand_file : plan.hands) {
      HandModel hand;
      if (!hand_file.empty()) {
        auto read = read_hand(hand_file);
        if (!read) return read.error();
        hand = std::move(read).value();
      }
      ComparedCell cell;
      cell.spoon = spoon.stem().string();
      cell.hand = hand.name;
      cell.severity = hand.severity;
      cell.is_random = trembles(hand);
      cell.runs.resize(cell.is_random ? static_cast<std::size_t>(plan.seeds) : 1);
      for (std::size_t run = 0; run < cell.runs.size(); ++run) {
        TrainingChoice choice;
        choice.task = plan.task;
        choice.spoon = spoon;
        choice.hand = hand_file;
        choice.seed = static_cast<std::uint32_t>(run + 1);
        jobs.push_back({cells.size(), run, choice});
      }
      cells.push_back(std::move(cell));
    }
  }
  std::vector<std::string> failures(jobs.size());
  std::atomic<std::size_t> next{0}, ended{0};
  std::atomic<bool> stopped{false};
  const auto work = [&] {
    for (std::size_t k = next++; k < jobs.size() && !stopped.load(); k = next++) {
      auto run = run_script_safely(plan, jobs[k].choice, stopped);
      if (run) {
        cells[jobs[k].cell].runs[jobs[k].run] = std::move(run).value();
      } else {
        failures[k] = run.error().message;
      }
      ++ended;
    }
  };
  std::vector<std::jthread> threads;
  const std::size_t count = std::min(static_cast<std::size_t>(workers), jobs.size());
  for (std::size_t k = 0; k < count; ++k) threads.emplace_back(work);
  while (ended.load() < jobs.size() && !stopped.load()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    report(ended.load(), jobs.size());
    if (is_stopped()) stopped = true;
  }
  threads.clear();  // waits for all of them
  if (stopped) return Error{ErrorCode::cancelled, "stopped"};
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    if (failures[k].empty()) continue;
    ComparedCell& cell = cells[jobs[k].cell];
    if (cell.failure.empty()) cell.failure = failures[k];
  }
  for (ComparedCell& cell : cells) {
    if (!cell.failure.empty()) cell.runs.clear();
  }
  return cells;
}

}  // namespace spoonbill
