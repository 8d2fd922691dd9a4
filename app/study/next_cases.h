// The cases that a study still needs. A pure function of its plan and of the results so far, so that a study
// may stop at any moment, and ends with the same results however many workers it has.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/study/study_case.h"
#include "app/study/study_plan.h"

namespace spoonbill {

struct DoneCase {
  StudyCase study_case;
  CaseResult result;
};
using CaseResults = std::map<std::string, DoneCase>;  // by case_key()

// A sweep of tilts for one spoon, food and friction, with all else as usual or with one factor varied; with
// several in a full grid.
struct StudySeries {
  StudyCase base;                          // the case of each tilt but for its tilt and its lattice and steps
  std::optional<StudyFactor> varied = {};  // the last of them
  bool is_for_claim = false;  // whether it tries the claim of Pungotra et al. 2013 (read_claim())
};

// Returns all series of a plan, in the order of the report.
std::vector<StudySeries> list_series(const StudyPlan& plan);

// Returns the case of a series at a tilt.
StudyCase case_at(const StudySeries& series, double tilt_deg);
// Returns the repeats of a case: with half the step, and with a finer lattice.
std::vector<StudyCase> list_repeats(const StudyCase& study_case);
StudyCase with_refinement(const StudyCase& study_case, int refinement);

// How far a repeat is from what it repeats.
struct CaseDifference {
  bool is_other_verdict = false;  // or only one of the two was judged
  // Relative change of the time of first spill, of cases that spill in both runs. Times are taken from the
  // start of the turn, and differences below a hundredth of a second do not count.
  double time = 0.0;
  // Change of the overhanging mass of food that does not yield, as a fraction of the food's mass.
  double mass = 0.0;
};
CaseDifference compare_cases(const StudyPlan& plan, const StudyCase& repeat, const CaseResult& usual,
                             const CaseResult& again);

// Returns the result of the finer lattice if the finest one, with which a case is tried where the usual and
// the finer one differ, confirms its verdict; null otherwise.
const CaseResult* find_confirmed_refinement(const StudyCase& usual, const CaseResults& results);

// A change of verdict of a series between two tilts that are at most finest_tilt_deg apart.
struct VerdictChange {
  double low_deg = 0.0, high_deg = 0.0;
};
inline constexpr double finest_tilt_deg = 1.0;

// Returns the tilts of a series that have results, ascending.
std::vector<double> list_known_tilts(const StudySeries& series, const CaseResults& results);
std::vector<VerdictChange> find_changes(const StudySeries& series, const CaseResults& results);

// Returns the result of a case; null if it is not known.
const CaseResult* find_result(const StudyCase& study_case, const CaseResults& results);

// Returns the cases that can be run now, each once, in a fixed order: first the cases of
// a sampled design and of a sensitivity analysis, and the plan's tilts of each series; then, between
// neighbouring tilts with different verdicts, tilts halfway, until they are finest_tilt_deg apart; then the
// repeats of the cases on both sides of each change, and a finest lattice where the finer one gives another
// verdict, or changes the time of first spill by a tenth or the overhanging mass by three hundredths. Empty
// if the study is complete.
std::vector<StudyCase> find_next_cases(const StudyPlan& plan, const CaseResults& results);

}  // namespace spoonbill
