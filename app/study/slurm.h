// Runs the cases of a study as arrays of Slurm tasks.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/study/study_parts.h"
#include "engine/base/result.h"

namespace spoonbill {

// How the tasks of a study are started.
struct SlurmJob {
  // The program with the arguments of the study; each task adds "--part NUMBER/COUNT".
  std::vector<std::string> command;
  std::filesystem::path folder;  // of the study; all machines must see it
  int count = 1;                 // number of parts
};

// Submits a task for each part and waits until every part has its file. Tasks of which nothing is queued or
// running any more and that have left no file are submitted again, five times at most. What is done is read
// from the files alone. An array has at most MaxArraySize - 1 tasks; more parts take several arrays.
// `show(done)` is called with the number of finished parts about twice a second. Fails if Slurm's commands
// are missing or refuse the job, and with ErrorCode::cancelled, after cancelling the tasks, once `is_stopped`
// returns true.
Status run_on_slurm(const SlurmJob& job, const std::function<void(int)>& show,
                    const std::function<bool()>& is_stopped);

}  // namespace spoonbill
