// The log of a person who trains: every attempt, in a local file of that person.
//
//   {"spoonbill_training_log": 1, "person": "ada"}                             line 1
//   {"date": "2026-12-01T11:00:00Z", "task": "carry", "spoon": "spoon-bent",
//    "hand": "limited wrist", "severity": 1, "seed": 1, "guidance": 0.5,
//    "end": "success", "time_s": 2.6, "score": 87.2, ...}                      a line for each attempt
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/training/hand_model.h"
#include "app/training/task.h"
#include "app/training/task_watch.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// An attempt that has ended. Plain data.
struct Attempt {
  std::string date;  // UTC, such as 2026-12-01T11:00:00Z
  std::string task, spoon, hand;
  double severity = 0.0;
  std::uint32_t seed = 1;
  double guidance = 0.0;  // strength
  TaskEnd end = TaskEnd::late;
  double time_s = 0.0;
  double score = 0.0;               // 0 to 100
  double food_lost_fraction = 0.0;  // 0 to 1
  std::optional<double> error_m;    // of a palpation
  double path_m = 0.0;
  double smoothness = 0.0;
  double tremor_m = 0.0;
  double wrist_used = 0.0;  // largest part of a turn's range, see find_wrist_used()
  double grip_used = 0.0;
  double largest_force_n = 0.0;
  std::string state_hash;
};

// Returns the largest part of the range of a wrist's turn, to the side of the turn, that was used; 0 for a
// hand without limits.
double find_wrist_used(const TaskResult& result, const HandModel& hand);

Json attempt_to_json(const Attempt& attempt);

// Attempts of a log, in the order in which they were logged.
struct LoggedAttempts {
  std::vector<Attempt> attempts;
  int unreadable_lines = 0;  // lines that were cut or changed
};

// The log of one person. Calls may block. Several programs may append to one log at once.
class PersonLog {
 public:
  // Names the log PERSON.jsonl in a folder, which need not exist. The error says which names are possible: 1
  // to 64 letters, digits, - and _.
  static Result<PersonLog> find(const std::filesystem::path& folder, const std::string& person);

  // Adds an attempt; creates the folder and the log if they are missing. Older attempts stay, also if the log
  // was cut or the disk is full. Refuses a file that is not a log of this person and of this version.
  Status append(const Attempt& attempt) const;

  // Returns all attempts; none if there is no log.
  Result<LoggedAttempts> read() const;

  // Deletes the log. ErrorCode::missing without a log. Refuses a file that is not a log of this person.
  Status forget() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  PersonLog(std::filesystem::path file, std::string person)
      : file_(std::move(file)), person_(std::move(person)) {}
  std::string header() const;
  Status check_header(std::string_view first_line) const;

  std::filesystem::path file_;
  std::string person_;
};

// Returns the strength with which the next attempt at a task should be guided: 1 before the first attempt,
// then less by an eightieth for each point of the mean score of the last three, and at least 0.
double find_next_guidance(const std::vector<Attempt>& attempts, const std::string& task);

}  // namespace spoonbill
