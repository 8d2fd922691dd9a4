#include "app/training/person_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/base/file.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr int log_version = 1;
constexpr std::size_t log_limit_bytes = std::size_t{16} << 20;
constexpr std::size_t longest_person = 64;
constexpr double largest_measure = 1e6;

// A measure of an attempt and its range.
struct MeasureField {
  const char* name;
  double Attempt::*member;
  Range<double> range;
};
constexpr auto measure_fields = std::to_array<MeasureField>({
    {"severity", &Attempt::severity, severity_range},
    {"guidance", &Attempt::guidance, {0.0, 1.0}},
    {"time_s", &Attempt::time_s, {0.0, largest_measure}},
    {"score", &Attempt::score, {0.0, 100.0}},
    {"food_lost_fraction", &Attempt::food_lost_fraction, {0.0, 1.0 + 1e-6}},
    {"path_m", &Attempt::path_m, {0.0, largest_measure}},
    {"smoothness", &Attempt::smoothness, {-largest_measure, 0.0}},
    {"tremor_m", &Attempt::tremor_m, {0.0, largest_measure}},
    {"wrist_used", &Attempt::wrist_used, {0.0, largest_measure}},
    {"grip_used", &Attempt::grip_used, {0.0, largest_measure}},
    {"largest_force_n", &Attempt::largest_force_n, {0.0, largest_measure}},
});
constexpr Range<double> error_range_m{0.0, 10.0};
constexpr std::uint64_t seed_limit = 0xffffffff;

bool is_person_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

std::optional<Attempt> read_attempt(std::string_view line) {
  const auto json = parse_json(std::string(line), "attempt");
  if (!json || !json->is_object()) return std::nullopt;
  FieldReader reader(json.value(), "attempt");
  Attempt attempt;
  attempt.date = reader.text("date");
  attempt.task = reader.text("task");
  attempt.spoon = reader.text("spoon");
  attempt.hand = reader.text("hand");
  attempt.seed = static_cast<std::uint32_t>(reader.unsigned_integer("seed", seed_limit));
  attempt.end = static_cast<TaskEnd>(reader.choose("end", task_end_names));
  for (const MeasureField& field : measure_fields) {
    attempt.*field.member = reader.number(field.name, field.range);
  }
  if (reader.has("error_m")) attempt.error_m = reader.number("error_m", error_range_m);
  attempt.state_hash = reader.text("state_hash");
  if (!reader.status().ok()) return std::nullopt;
  return attempt;
}

// A file that is open and locked; closing it releases the lock.
class LockedFile {
 public:
  static Result<LockedFile> open_to_append(const std::filesystem::path& file) {
    const int descriptor =
        open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
    if (descriptor < 0) {
      return Error{ErrorCode::unwritable,
                   file.string() + ": the log cannot be written: " + std::strerror(errno)};
    }
    LockedFile opened(descriptor);
    struct stat facts {};
    if (fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) {
      return Error{ErrorCode::unwritable, file.string() + ": is not a regular file; remove it"};
    }
    while (flock(descriptor, LOCK_EX) != 0) {
      if (errno != EINTR) return Error{ErrorCode::unwritable, file.string() + ": the log cannot be locked"};
    }
    return opened;
  }
  LockedFile(LockedFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  LockedFile& operator=(LockedFile&&) = delete;
  ~LockedFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }

  off_t size() const { return lseek(descriptor_, 0, SEEK_END); }
  std::string read_at(off_t offset, std::size_t count) const {
    std::string bytes(count, '\0');
    const ssize_t got = pread(descriptor_, bytes.data(), count, offset);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  // Adds all bytes, or none of them.
  bool append(const std::string& bytes) const {
    const off_t before = size();
    if (write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()) &&
        fsync(descriptor_) == 0) {
      return true;
    }
    const int problem = errno;
    if (ftruncate(descriptor_, before) != 0) return false;
    errno = problem;
    return false;
  }
  bool clear() const { return ftruncate(descriptor_, 0) == 0; }

 private:
  explicit LockedFile(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace

double find_wrist_used(const TaskResult& result, const HandModel& hand) {
  if (!hand.wrist) return 0.0;
  double used = 0.0;
  for (std::size_t k = 0; k < wrist_turn_count; ++k) {
    const Range<double>&turned = result.wrist_rad[k], &range = hand.wrist->range_rad[k];
    if (range.high > 0.0) used = std::max(used, turned.high / range.high);
    if (range.low < 0.0) used = std::max(used, turned.low / range.low);
  }
  return used;
}

Json attempt_to_json(const Attempt& attempt) {
  Json json = {{"date", attempt.date},   {"task", attempt.task},
               {"spoon", attempt.spoon}, {"hand", attempt.hand},
               {"seed", attempt.seed},   {"end", task_end_names[static_cast<std::size_t>(attempt.end)]}};
  for (const MeasureField& field : measure_fields) json[field.name] = attempt.*field.member;
  if (attempt.error_m) json["error_m"] = *attempt.error_m;
  json["state_hash"] = attempt.state_hash;
  return json;
}

Result<PersonLog> PersonLog::find(const std::filesystem::path& folder, const std::string& person) {
  const bool is_name = !person.empty() && person.size() <= longest_person &&
                       std::all_of(person.begin(), person.end(), is_person_character);
  if (!is_name) {
    return Error{ErrorCode::out_of_range,
                 "the name of a person must have 1 to 64 letters, digits, - and _, such as P-07"};
  }
  return PersonLog(folder / (person + ".jsonl"), person);
}

std::string PersonLog::header() const {
  return Json({{"spoonbill_training_log", log_version}, {"person", person_}}).dump() + "\n";
}

Status PersonLog::check_header(std::string_view first_line) const {
  const auto json = parse_json(std::string(first_line), file_.string());
  if (!json || !json->is_object()) {
    return Error{ErrorCode::unsupported, file_.string() + ": is not a log of training; move it away"};
  }
  FieldReader reader(json.value(), file_.string());
  reader.version("spoonbill_training_log", log_version);
  const std::string person = reader.text("person");
  if (!reader.status().ok()) return reader.status();
  if (person == person_) return {};
  return Error{ErrorCode::inconsistent, file_.string() + ": is the log of another person; move it away"};
}

Status PersonLog::append(const Attempt& attempt) const {
  std::error_code problem;
  std::filesystem::create_directories(file_.parent_path(), problem);
  if (problem) {
    return Error{ErrorCode::unwritable,
                 file_.parent_path().string() + ": cannot be created: " + problem.message()};
  }
  auto file = LockedFile::open_to_append(file_);
  if (!file) return file.error();
  const off_t size = file->size();
  if (size < 0) return Error{ErrorCode::unreadable, file_.string() + ": the log cannot be read"};
  const std::string begin = file->read_at(0, header().size() + longest_person);
  std::string bytes = attempt_to_json(attempt).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  // A header that was cut as it was written has no attempts after it.
  const bool is_cut_header =
      static_cast<std::size_t>(size) < header().size() && header().compare(0, begin.size(), begin) == 0;
  if (is_cut_header) {
    if (!file->clear()) return Error{ErrorCode::unwritable, file_.string() + ": the log cannot be written"};
    bytes = header() + bytes;
  } else {
    if (Status checked = check_header(begin.substr(0, begin.find('\n'))); !checked) return checked;
    // A line that was cut must not swallow the next one.
    if (file->read_at(size - 1, 1) != "\n") bytes = "\n" + bytes;
  }
  if (file->append(bytes)) return {};
  return Error{ErrorCode::unwritable, file_.string() + ": the attempt is not logged: " +
                                          std::strerror(errno) + "; the older attempts are kept"};
}

Result<LoggedAttempts> PersonLog::read() const {
  std::error_code ignored;
  LoggedAttempts logged;
  if (std::filesystem::symlink_status(file_, ignored).type() == std::filesystem::file_type::not_found) {
    return logged;
  }
  const auto text = read_file(file_, log_limit_bytes, "delete old attempts, or the log with --forget");
  if (!text) return text.error();
  const std::string_view all = text.value();
  const std::size_t first_end = std::min(all.find('\n'), all.size());
  if (all.size() < header().size() && header().compare(0, all.size(), all) == 0) return logged;
  if (Status checked = check_header(all.substr(0, first_end)); !checked) return checked.error();
  for (std::size_t at = first_end + 1; at < all.size();) {
    const std::size_t end = std::min(all.find('\n', at), all.size());
    const std::string_view line = all.substr(at, end - at);
    at = end + 1;
    if (line.empty()) continue;
    if (auto attempt = read_attempt(line)) {
      logged.attempts.push_back(std::move(*attempt));
    } else {
      ++logged.unreadable_lines;
    }
  }
  return logged;
}

Status PersonLog::forget() const {
  std::error_code problem;
  if (std::filesystem::symlink_status(file_, problem).type() == std::filesystem::file_type::not_found) {
    return Error{ErrorCode::missing, "there is no log of " + person_ + ": " + file_.string()};
  }
  if (const auto read_first = read(); !read_first) return read_first.error();
  if (std::filesystem::remove(file_, problem) && !problem) return {};
  return Error{ErrorCode::unwritable, file_.string() + ": cannot be deleted: " + problem.message()};
}

double find_next_guidance(const std::vector<Attempt>& attempts, const std::string& task) {
  constexpr int counted = 3;
  constexpr double unguided_score = 80.0;
  double sum = 0.0;
  int count = 0;
  for (auto attempt = attempts.rbegin(); attempt != attempts.rend() && count < counted; ++attempt) {
    if (attempt->task != task) continue;
    sum += attempt->score;
    ++count;
  }
  return count == 0 ? 1.0 : std::clamp(1.0 - sum / count / unguided_score, 0.0, 1.0);
}

}  // namespace spoonbill
