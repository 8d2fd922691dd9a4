// Report of a task that was trained.
#pragma once

#include "app/report/fact_sheet.h"
#include "app/training/hand_model.h"
#include "app/training/task.h"
#include "app/training/task_watch.h"

namespace spoonbill {

// Adds the result of a task that was done with a hand: for people, and as the members of a JSON object.
void add_task_result(const Task& task, const HandModel& hand, const TaskResult& result, FactSheet& facts);

}  // namespace spoonbill
