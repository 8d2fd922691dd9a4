#include "app/study/slurm.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#include "app/child_process.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

constexpr int submission_limit = 6;
constexpr std::chrono::milliseconds stop_interval{50};  // between questions whether the study is stopped
constexpr int stops_a_query = 10;                       // number of these questions between those to Slurm
// Time for which the files of tasks that have ended may take to appear, as on a network file system.
constexpr std::chrono::seconds file_patience{10};
constexpr int usual_array_size = 1001;  // MaxArraySize unless the configuration says otherwise

// Runs one of Slurm's commands and returns its output.
Result<std::string> ask_slurm(std::vector<std::string> arguments) {
  const std::string name = arguments.front();
  int ends[2];
  if (pipe(ends) != 0) return Error{ErrorCode::unavailable, name + ": no pipe can be made"};
  const pid_t process = start_process(arguments, -1, ends[1]);
  close(ends[1]);
  std::string output;
  char bytes[4096];
  for (ssize_t count = 0; process > 0 && (count = read(ends[0], bytes, sizeof bytes)) > 0;) {
    output.append(bytes, static_cast<std::size_t>(count));
  }
  close(ends[0]);
  if (process < 0) {
    return Error{ErrorCode::unavailable, name + ": cannot be started; install Slurm, or leave out --slurm"};
  }
  const int state = wait_for_process(process);
  if (!WIFEXITED(state) || WEXITSTATUS(state) != 0) {
    return Error{ErrorCode::process_failed, name + ": failed; try it by hand to see why"};
  }
  return output;
}

std::optional<int> parse_count(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '=')) text.remove_prefix(1);
  int count = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), count);
  return parsed.ec == std::errc() && count > 0 ? std::optional(count) : std::nullopt;
}

// Returns the largest number of tasks in an array.
Result<int> find_array_limit() {
  const auto configuration = ask_slurm({"scontrol", "show", "config"});
  if (!configuration) return configuration.error();
  const std::string_view text = configuration.value();
  const std::size_t at = text.find("MaxArraySize");
  const auto size = at == std::string_view::npos ? std::nullopt : parse_count(text.substr(at + 12));
  return std::max(1, size.value_or(usual_array_size) - 1);
}

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

// Writes the script of the tasks. The number of a part is the sum of its array's offset and its own number.
Status write_script(const SlurmJob& job, const std::filesystem::path& script) {
  std::string text = "#!/bin/sh\n";
  text += "exec";
  for (const std::string& word : job.command) text += " " + quoted(word);
  text += " --part \"$((${SPOONBILL_FIRST_PART:-0} + ${SLURM_ARRAY_TASK_ID:-1}))/" +
          std::to_string(job.count) + "\"\n";
  return write_file(script, text, Durability::now, {NamedBy::program, false});
}

// Submits the parts as arrays of tasks with the name `name`.
Status submit(const std::vector<int>& parts, int array_limit, const std::string& name,
              const std::filesystem::path& script) {
  for (std::size_t begin = 0; begin < parts.size();) {
    // The numbers of an array's tasks are below its limit, so later parts are counted from an offset.
    const int offset = (parts[begin] - 1) / array_limit * array_limit;
    std::string numbers;
    std::size_t end = begin;
    for (; end < parts.size() && parts[end] - offset <= array_limit; ++end) {
      const std::size_t first = end;
      while (end + 1 < parts.size() && parts[end + 1] == parts[end] + 1 &&
             parts[end + 1] - offset <= array_limit) {
        ++end;
      }
      numbers += (numbers.empty() ? "" : ",") + std::to_string(parts[first] - offset);
      if (end > first) numbers += "-" + std::to_string(parts[end] - offset);
    }
    const auto answer = ask_slurm({"sbatch", "--parsable", "--job-name=" + name, "--output=/dev/null",
                                   "--export=ALL,SPOONBILL_FIRST_PART=" + std::to_string(offset),
                                   "--array=" + numbers, script.string()});
    if (!answer) return answer.error();
    begin = end;
  }
  return {};
}

// Returns whether tasks of this name are queued or running; empty if Slurm does not answer.
std::optional<bool> are_any_left(const std::string& name) {
  const auto queued = ask_slurm({"squeue", "--noheader", "--format=%i", "--name=" + name});
  return queued ? std::optional(!queued->empty()) : std::nullopt;
}

// Returns the parts without a file. Lists the folder, because a network file system may answer a question for
// one file from its memory.
std::vector<int> find_missing(const SlurmJob& job) {
  std::set<std::filesystem::path> files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(parts_folder(job.folder), failure)) {
    files.insert(entry.path());
  }
  std::vector<int> missing;
  for (int number = 1; number <= job.count; ++number) {
    if (!files.contains(part_file(job.folder, {number, job.count}))) missing.push_back(number);
  }
  return missing;
}

// Waits until every part has a file, or nothing is queued or running any more. Returns the missing parts.
Result<std::vector<int>> wait_for_parts(const SlurmJob& job, const std::string& name,
                                        const std::function<void(int)>& show,
                                        const std::function<bool()>& is_stopped) {
  auto left_since = std::chrono::steady_clock::now();  // since when nothing is queued or running
  for (;;) {
    for (int k = 0; k < stops_a_query; ++k) {
      if (is_stopped()) return Error{ErrorCode::cancelled, "stopped"};
      std::this_thread::sleep_for(stop_interval);
    }
    const std::vector<int> missing = find_missing(job);
    show(job.count - static_cast<int>(missing.size()));
    const auto now = std::chrono::steady_clock::now();
    // As long as Slurm does not answer, its tasks may be running.
    if (are_any_left(name).value_or(true)) left_since = now;
    if (missing.empty() || now - left_since >= file_patience) return missing;
  }
}

Status run_all_parts(const SlurmJob& job, const std::string& name, const std::filesystem::path& script,
                     const std::function<void(int)>& show, const std::function<bool()>& is_stopped) {
  const auto array_limit = find_array_limit();
  if (!array_limit) return array_limit.error();
  std::vector<int> missing = find_missing(job);
  for (int submission = 1; !missing.empty(); ++submission) {
    if (submission > submission_limit) {
      return Error{ErrorCode::process_failed, std::to_string(missing.size()) +
                                                  " tasks have failed again and again; run " +
                                                  script.string() + " by hand to see why"};
    }
    if (Status submitted = submit(missing, array_limit.value(), name, script); !submitted) return submitted;
    auto still_missing = wait_for_parts(job, name, show, is_stopped);
    if (!still_missing) return still_missing.error();
    missing = std::move(still_missing).value();
  }
  return {};
}

}  // namespace

Status run_on_slurm(const SlurmJob& job, const std::function<void(int)>& show,
                    const std::function<bool()>& is_stopped) {
  const std::filesystem::path script = std::filesystem::absolute(job.folder) / "slurm-task.sh";
  if (Status written = write_script(job, script); !written) return written;
  const std::string name = "spoonbill-" + std::to_string(getpid());
  Status ran = run_all_parts(job, name, script, show, is_stopped);
  if (!ran)
    start_process({"scancel", "--name=" + name}, -1, -1);  // without waiting: a stop ends the program soon
  std::error_code ignored;
  const bool is_needed = !ran && ran.error().code == ErrorCode::process_failed;
  if (!is_needed) std::filesystem::remove(script, ignored);
  return ran;
}

}  // namespace spoonbill
