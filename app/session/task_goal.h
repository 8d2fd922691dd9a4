// The goal of a task, as the scene shows it.
#pragma once

#include "app/session/session.h"
#include "app/training/task.h"
#include "app/training/training_scene.h"
#include "render/view_settings.h"

namespace spoonbill {

// Returns the path, the places to reach and the levels of a task; after a palpation also the lump and the
// mark.
GoalMarks make_goal(const Task& task, const TrainingScene& scene, const TrainingFacts& facts);

// Adds the pose that the person wants, where the hand does not reach it: a cross at the rim's centre, or at
// the finger, and a line along the handle.
void add_wanted_pose(const TrainingScene& scene, const TrainingFacts& facts, GoalMarks& goal);

// Returns the box about all marks; empty for none.
Box find_bounds(const GoalMarks& goal);

}  // namespace spoonbill
