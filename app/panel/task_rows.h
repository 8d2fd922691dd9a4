// Rows of the panel for a task that is trained.
#pragma once

#include "app/panel/panel.h"
#include "app/session/session.h"
#include "app/training/hand_model.h"
#include "app/training/task.h"

namespace spoonbill {

TaskRows make_task_rows(const Task& task, const HandModel& hand, const TrainingFacts& facts);

}  // namespace spoonbill
