// The page of a comparison of spoons by hand, and its table of runs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/session/task_comparison.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the page, which needs no other file and no network. Errors: those of make_page().
Result<std::string> make_comparison_page(const Task& task, const ComparisonPlan& plan,
                                         const std::vector<ComparedCell>& cells);

// Returns a line for each run, as CSV (RFC 4180).
std::string make_comparison_csv(const std::vector<ComparedCell>& cells);

// Returns what `compare --json` prints of the cells: for each measure of a run NAME_mean and NAME_deviation,
// in SI units, unless no run has a result.
Json comparison_to_json(const std::vector<ComparedCell>& cells);

// Answer to the question whether a hand with a limited wrist fails with the straight spoon and succeeds with
// another. Plain data.
struct WristAnswer {
  bool is_known = false;  // false if the comparison has no such hand or no straight spoon that can be used
  std::optional<bool> is_true;  // empty if not known, or if the verdicts do not settle it
  CellVerdict straight = CellVerdict::unusable;
  std::vector<std::string> better;  // spoons with which the hand succeeds
  std::string text;                 // one sentence
};

// `straight` is the name of the straight spoon.
WristAnswer find_wrist_answer(const std::string& straight, const std::vector<ComparedCell>& cells);

}  // namespace spoonbill
