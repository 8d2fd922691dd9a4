#include "app/session/task_comparison.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <map>
#include <thread>
#include <utility>

#include "app/session/lockstep.h"
#include "app/training/person_log.h"
#include "engine/base/assert.h"
#include "engine/base/text.h"

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

// Refuses a name that an earlier file has; otherwise keeps it.
Status keep_name(const std::string& name, const std::filesystem::path& file,
                 std::map<std::string, std::filesystem::path>& names) {
  const auto [found, is_new] = names.emplace(name, file);
  if (is_new) return {};
  return Error{ErrorCode::duplicate,
               file.string() + ": has the name '" + excerpt(name) + "' of " +
                   (found->second.empty() ? "the hand that is not modelled" : found->second.string()) +
                   "; give one of them another name",
               "name"};
}

// Reads the hands of a comparison, in order.
Result<std::vector<HandModel>> read_compared_hands(const std::vector<std::filesystem::path>& files) {
  std::vector<HandModel> hands;
  std::map<std::string, std::filesystem::path> names;
  for (const std::filesystem::path& file : files) {
    HandModel hand;
    if (!file.empty()) {
      auto read = read_hand(file);
      if (!read) return read.error();
      hand = std::move(read).value();
    }
    if (Status kept = keep_name(name_of_hand(hand.name), file, names); !kept) return kept.error();
    hands.push_back(std::move(hand));
  }
  return hands;
}

}  // namespace

int ComparedCell::success_count() const {
  return static_cast<int>(std::count_if(runs.begin(), runs.end(), [](const ComparedRun& run) {
    return run.failure.empty() && run.result.end == TaskEnd::success;
  }));
}

int ComparedCell::result_count() const {
  return static_cast<int>(
      std::count_if(runs.begin(), runs.end(), [](const ComparedRun& run) { return run.failure.empty(); }));
}

std::string ComparedCell::failure() const {
  const auto found =
      std::find_if(runs.begin(), runs.end(), [](const ComparedRun& run) { return !run.failure.empty(); });
  return found == runs.end() ? std::string() : found->failure;
}

MeanOfRuns find_mean(const ComparedCell& cell, const std::function<double(const ComparedRun&)>& measure) {
  MeanOfRuns found;
  std::vector<double> values;
  for (const ComparedRun& run : cell.runs) {
    if (run.failure.empty()) values.push_back(measure(run));
  }
  const auto count = static_cast<double>(values.size());
  for (const double value : values) found.mean += value / count;
  double squares = 0.0;
  for (const double value : values) squares += std::pow(value - found.mean, 2);
  if (values.size() > 1) found.deviation = std::sqrt(squares / (count - 1.0));
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

Range<double> find_rate_interval(const ComparedCell& cell) {
  const int runs = static_cast<int>(cell.runs.size()), successes = cell.success_count();
  const int given_up = runs - cell.result_count();
  return {find_rate_interval(successes, runs).low, find_rate_interval(successes + given_up, runs).high};
}

CellVerdict judge(const ComparedCell& cell) {
  if (cell.result_count() == 0) return CellVerdict::unusable;
  if (!cell.is_random) return cell.success_count() > 0 ? CellVerdict::succeeds : CellVerdict::fails;
  const Range<double> rate = find_rate_interval(cell);
  if (rate.low > 0.5) return CellVerdict::succeeds;
  return rate.high < 0.5 ? CellVerdict::fails : CellVerdict::undecided;
}

Result<std::vector<ComparedCell>> run_comparison(
    const ComparisonPlan& plan, int workers, const std::function<bool()>& is_stopped,
    const std::function<void(std::size_t, std::size_t)>& report) {
  SPOONBILL_ASSERT(workers >= 1 && plan.seeds >= 1);
  if (const auto task = read_task(plan.task); !task) return task.error();
  const auto hands = read_compared_hands(plan.hands);
  if (!hands) return hands.error();
  std::map<std::string, std::filesystem::path> spoons;
  std::vector<ComparedCell> cells;
  std::vector<ComparisonJob> jobs;
  for (const std::filesystem::path& spoon : plan.spoons) {
    if (Status kept = keep_name(spoon.stem().string(), spoon, spoons); !kept) return kept.error();
    for (std::size_t h = 0; h < plan.hands.size(); ++h) {
      const HandModel& hand = hands.value()[h];
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
        choice.hand = plan.hands[h];
        choice.seed = static_cast<std::uint32_t>(run + 1);
        jobs.push_back({cells.size(), run, choice});
      }
      cells.push_back(std::move(cell));
    }
  }
  std::atomic<std::size_t> next{0}, ended{0};
  std::atomic<bool> stopped{false};
  const auto work = [&] {
    for (std::size_t k = next++; k < jobs.size() && !stopped.load(); k = next++) {
      auto run = run_script_safely(plan, jobs[k].choice, stopped);
      // No other thread reads or writes this run.
      ComparedRun& kept = cells[jobs[k].cell].runs[jobs[k].run];
      if (run) {
        kept = std::move(run).value();
      } else {
        kept.seed = jobs[k].choice.seed;
        kept.failure = run.error().message;
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
  return cells;
}

}  // namespace spoonbill
