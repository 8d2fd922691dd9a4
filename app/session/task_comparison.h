// Comparison of spoons by hand: the same script of a task is done with each spoon and each hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/session/training_session.h"
#include "app/training/task_watch.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "haptic/script.h"

namespace spoonbill {

// Plain data.
struct ComparisonPlan {
  std::filesystem::path task;
  Script script;  // says where the bowl shall go, whatever the spoon
  std::vector<std::filesystem::path> spoons;
  std::vector<std::filesystem::path> hands;  // an empty path: a hand that does all that is asked
  int seeds = 20;                            // number of runs with a hand that trembles
  InstructionSet instruction_set = best_instruction_set();
};

// A run that has ended. Plain data.
struct ComparedRun {
  std::uint32_t seed = 1;
  TaskResult result;
  double score = 0.0;
  double wrist_used = 0.0;  // see find_wrist_used()
};

// All runs of one spoon with one hand. Plain data.
struct ComparedCell {
  std::string spoon;  // name of its file
  std::string hand;   // empty: not modelled
  double severity = 0.0;
  bool is_random = false;         // true if the hand trembles; otherwise there is one run
  std::string failure;            // why the spoon cannot be used; empty if it can
  std::vector<ComparedRun> runs;  // in the order of the seeds

  int success_count() const;
};

// A mean with its standard deviation over runs.
struct MeanOfRuns {
  double mean = 0.0, deviation = 0.0;
};
MeanOfRuns find_mean(const ComparedCell& cell, const std::function<double(const ComparedRun&)>& measure);

// Returns the 95 % interval of a success rate, after `successes` of `runs` (Wilson 1927). 0 to 1 without
// runs.
Range<double> find_rate_interval(int successes, int runs);

enum class CellVerdict { succeeds, fails, undecided, unusable };
inline constexpr const char* cell_verdict_names[] = {"succeeds", "fails", "undecided", "unusable"};

// Returns whether a spoon does the task with a hand. Without tremor, the one run says so. With tremor, it
// succeeds or fails if the interval of its success rate is above or below a half.
CellVerdict judge(const ComparedCell& cell);

// Runs all cells on `workers` threads. The result does not depend on their number. `is_stopped` is asked on
// the calling thread, which also reports the number of runs that have ended; once it returns true, the result
// is ErrorCode::cancelled. Fails if the task or a hand cannot be read.
Result<std::vector<ComparedCell>> run_comparison(const ComparisonPlan& plan, int workers,
                                                 const std::function<bool()>& is_stopped,
                                                 const std::function<void(std::size_t, std::size_t)>& report);

}  // namespace spoonbill
