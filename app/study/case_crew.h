// Runs cases of a study on several threads.
#pragma once

#include <functional>
#include <vector>

#include "app/study/case_trial.h"
#include "app/study/study_case.h"
#include "app/study/study_plan.h"
#include "engine/base/result.h"

namespace spoonbill {

// Receives each result on the calling thread, in the order in which cases end. An error stops the work.
using CaseReceiver = std::function<Status(const StudyCase&, const CaseResult&)>;

// Runs all cases on `workers` threads and returns when they have ended. Spoons of one shape share their
// results. `is_stopped` is asked about every tenth of a second on the calling thread; once it returns true,
// cases that are running are given up, and the result is ErrorCode::cancelled.
Status run_cases(const StudyPlan& plan, const std::vector<StudyCase>& cases, int workers,
                 const CaseReceiver& receive, const std::function<bool()>& is_stopped);

}  // namespace spoonbill
