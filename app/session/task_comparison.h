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
  std::filesystem::path script_file;  // named in reports
  Script script;                      // says where the bowl shall go, whatever the spoon
  std::vector<std::filesystem::path> spoons;
  std::vector<std::filesystem::path> hands;  // an empty path: a hand that does all that is asked
  int seeds = 20;                            // number of runs with a hand that trembles
  InstructionSet instruction_set = best_instruction_set();
};

// A run that has ended. Plain data.
struct ComparedRun {
  std::uint32_t seed = 1;
  std::string failure;  // why the run was given up; empty if it has a result
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
  std::vector<ComparedRun> runs;  // in the order of the seeds

  // Returns the numbers of runs that have succeeded and of runs that have a result.
  int success_count() const;
  int result_count() const;
  // Returns why a run was given up, of the first one that was; empty if all have a result.
  std::string failure() const;
};

// A mean with its standard deviation, over the runs that have a result.
struct MeanOfRuns {
  double mean = 0.0, deviation = 0.0;
};
MeanOfRuns find_mean(const ComparedCell& cell, const std::function<double(const ComparedRun&)>& measure);

// Returns the 95 % interval of a success rate, after `successes` of `runs` (Wilson 1927). 0 to 1 without
// runs.
Range<double> find_rate_interval(int successes, int runs);
// Returns that of a cell. A run that was given up might have failed or succeeded: the interval holds for
// both.
Range<double> find_rate_interval(const ComparedCell& cell);

enum class CellVerdict { succeeds, fails, undecided, unusable };
inline constexpr const char* cell_verdict_names[] = {"succeeds", "fails", "undecided", "unusable"};

// Returns whether a spoon does the task with a hand. Without tremor, the one run decides. With tremor, the
// spoon succeeds or fails if the interval of its success rate is above or below a half. It is unusable if no
// run has a result.
CellVerdict judge(const ComparedCell& cell);

// Runs all cells on `workers` threads: those of the first spoon, in the order of the hands, then those of the
// next. The result does not depend on the number of threads. A spoon that cannot be used and a run that is
// given up do not stop the others. `is_stopped` is asked on the calling thread, which also reports the number
// of runs that have ended; once it returns true, the result is ErrorCode::cancelled. Fails if the task or a
// hand cannot be read, and if two spoons or two hands have the same name, because reports know them by it.
Result<std::vector<ComparedCell>> run_comparison(const ComparisonPlan& plan, int workers,
                                                 const std::function<bool()>& is_stopped,
                                                 const std::function<void(std::size_t, std::size_t)>& report);

}  // namespace spoonbill
