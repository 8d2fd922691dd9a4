// Runs the trial of one case of a study.
#pragma once

#include <functional>

#include "app/study/study_case.h"
#include "app/study/study_plan.h"
#include "engine/base/result.h"
#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/trial.h"

namespace spoonbill {

// The longest motion of a case, from the lowering of the food to the verdict.
inline constexpr double case_motion_s = 6.0;
// The longest time that the food gets to come to rest before the turn. Food that yields creeps on.
inline constexpr double case_settling_s = 1.5;
// Food has settled after the turn when its centre of mass has stayed within case_rest_distance_m for
// case_rest_s, which is a mean speed below 0.1 mm/s.
inline constexpr double case_rest_distance_m = 0.05e-3;
inline constexpr double case_rest_s = 0.5;

// Returns the scene of a case: the food just above the spoon, over the centre of the rim, and the trial that
// lays it in and tilts the spoon. Fails if the food does not fit over the bowl, and if the trial refuses it.
Result<Scene> make_case_scene(const StudyPlan& plan, const StudyCase& study_case);

// Called after each tick; the trial stops early if it returns false.
using CaseWatch = std::function<bool(const Trial&, const Simulation&)>;

// Runs a case until the food has settled after the turn or has left the bowl, or for case_motion_s. Uses no
// state but its arguments, so that it may run on any thread. A case that cannot be judged is a result with a
// failure; ErrorCode::cancelled if `watch` returned false. `end`, if not null, receives the bodies as they
// are at the end.
Result<CaseResult> run_case(const StudyPlan& plan, const StudyCase& study_case, const CaseWatch& watch = {},
                            Scene* end = nullptr);

}  // namespace spoonbill
