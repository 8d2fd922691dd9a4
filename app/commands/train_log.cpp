#include "app/commands/train_log.h"

#include <array>
#include <ctime>

#include "app/files/state_folder.h"
#include "app/report/fact_sheet.h"
#include "app/report/progress_page.h"
#include "app/report/quantity_text.h"
#include "engine/base/file.h"
#include "haptic/recording_lines.h"

namespace spoonbill {
namespace {

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

}  // namespace

Result<PersonLog> find_person_log(const std::string& person) {
  const auto folder = state_folder();
  if (!folder) return folder.error();
  return PersonLog::find(folder.value() / "training", person);
}

Status log_attempt(const PersonLog& log, const TrainingSetting& setting, const TaskResult& result,
                   std::uint64_t state_hash) {
  Attempt attempt;
  attempt.date = utc_now();
  attempt.task = setting.task.name;
  attempt.spoon = setting.identity["spoon"].get<std::string>();
  attempt.hand = setting.hand.name;
  attempt.severity = setting.hand.severity;
  attempt.seed = setting.seed;
  attempt.guidance = setting.guidance;
  attempt.end = result.end;
  attempt.time_s = result.time_s;
  attempt.score = result.score(setting.task);
  attempt.food_lost_fraction = result.food_lost_fraction;
  attempt.error_m = result.error_m;
  attempt.path_m = result.path_m;
  attempt.smoothness = result.smoothness;
  attempt.tremor_m = result.tremor_m;
  attempt.wrist_used = find_wrist_used(result, setting.hand);
  attempt.grip_used = result.grip_used;
  attempt.largest_force_n = result.largest_force_n;
  attempt.state_hash = hash_text(state_hash);
  return log.append(attempt);
}

Result<double> choose_guidance(const PersonLog& log, const std::filesystem::path& task_file) {
  const auto task = read_task(task_file);
  if (!task) return task.error();
  const auto logged = log.read();
  if (!logged) return logged.error();
  return find_next_guidance(logged->attempts, task->name);
}

Status show_progress(const std::string& person, const std::filesystem::path& page, const OutputOptions& how,
                     bool as_json, Console& console) {
  const auto log = find_person_log(person);
  if (!log) return log.error();
  const auto logged = log->read();
  if (!logged) return logged.error();
  if (!page.empty()) {
    const auto text = make_progress_page(person, logged.value());
    if (!text) return text.error();
    if (Status written = write_file(page, text.value(), Durability::now, how); !written) return written;
  }
  FactSheet facts;
  facts.add("Person", person, "person", person);
  Json all = Json::array();
  for (const Attempt& attempt : logged->attempts) {
    all.push_back(attempt_to_json(attempt));
    facts.add(attempt.date,
              attempt.task + (attempt.spoon.empty() ? "" : ", " + attempt.spoon) + ", " +
                  name_of_hand(attempt.hand) + ": " + task_end_names[static_cast<std::size_t>(attempt.end)] +
                  ", score " + decimals_text(attempt.score, 0) + ", " + decimals_text(attempt.time_s, 1) +
                  " s",
              "", nullptr);
  }
  facts.add("Attempts", std::to_string(all.size()), "attempts", all);
  if (logged->unreadable_lines > 0 || as_json) {
    facts.add("Unreadable lines", std::to_string(logged->unreadable_lines), "unreadable_lines",
              logged->unreadable_lines);
  }
  facts.add("Log", log->file().string(), "log", log->file().string());
  if (!page.empty()) facts.add("Page", page.string(), "page", page.string());
  facts.print(console.out, as_json);
  return {};
}

Status forget_person(const std::string& person, bool as_json, Console& console) {
  const auto log = find_person_log(person);
  if (!log) return log.error();
  if (Status forgotten = log->forget(); !forgotten) return forgotten;
  FactSheet facts;
  facts.add("Forgotten", person, "forgotten", person);
  facts.print(console.out, as_json);
  return {};
}

}  // namespace spoonbill
