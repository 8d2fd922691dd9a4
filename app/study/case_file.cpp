#include "app/study/case_file.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace spoonbill {
namespace {

constexpr int file_version = 1;
constexpr std::size_t file_limit_bytes = std::size_t{256} << 20;

constexpr const char* file_name = "cases.jsonl";

// Returns the files of a folder that have cases, also those that create_growing() has put aside, in the order
// of their names.
std::vector<std::filesystem::path> list_case_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    const bool has_cases = name == file_name || name.starts_with(std::string(file_name) + ".part");
    if (has_cases && entry.is_regular_file(failure) && entry.file_size(failure) > 0) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string first_line(const Json& plan) {
  return Json{{"spoonbill_study_cases", file_version}, {"plan", plan}}.dump() + "\n";
}

std::string case_line(const DoneCase& done) {
  return Json{{"case", case_to_json(done.study_case)}, {"result", result_to_json(done.result)}}.dump() + "\n";
}

}  // namespace

std::filesystem::path parts_folder(const std::filesystem::path& folder) {
  return folder / "parts";
}

std::string cases_text(const Json& plan, const CaseResults& results) {
  std::string text = first_line(plan);
  for (const auto& [key, done] : results) text += case_line(done);
  return text;
}

Result<CaseResults> read_cases(const std::filesystem::path& file, const Json& plan) {
  CaseResults results;
  auto text = read_file(file, file_limit_bytes);
  if (!text) return text.error();
  std::size_t begin = 0;
  for (int line = 1;; ++line) {
    const std::size_t end = text->find('\n', begin);
    if (end == std::string::npos) return results;
    const std::string source = file.string() + ": line " + std::to_string(line);
    const auto json = parse_json(text->substr(begin, end - begin), source);
    if (!json) return json.error();
    begin = end + 1;
    if (line == 1) {
      if (!json->is_object() || !json->contains("plan") || json.value()["plan"] != plan) {
        return Error{ErrorCode::mismatch,
                     file.string() +
                         ": the folder has the cases of another study; choose another folder, or "
                         "use --restart to replace them"};
      }
      continue;
    }
    if (!json->is_object() || !json->contains("case") || !json->contains("result")) {
      return Error{ErrorCode::malformed, source + ": a line must have a case and a result; use --restart"};
    }
    auto study_case = case_from_json(json.value()["case"], source);
    if (!study_case) return study_case.error();
    auto result = result_from_json(json.value()["result"], source);
    if (!result) return result.error();
    results.insert_or_assign(case_key(study_case.value()),
                             DoneCase{study_case.value(), std::move(result).value()});
  }
}

Result<CaseResults> read_done_cases(const std::filesystem::path& folder, const Json& plan) {
  CaseResults results;
  for (const std::filesystem::path& file : list_case_files(folder)) {
    auto read = read_cases(file, plan);
    if (!read) return read;
    results.merge(read.value());
  }
  return results;
}

Result<CaseFile> CaseFile::open(const std::filesystem::path& folder, const Json& plan, bool restarts) {
  const std::filesystem::path file = folder / file_name;
  CaseResults results;
  if (!restarts) {
    auto read = read_done_cases(folder, plan);
    if (!read) return read.error();
    results = std::move(read).value();
  }
  auto out = OutputFile::create_growing(file, {NamedBy::program, false});
  if (!out) return out.error();
  const std::filesystem::path growing = out->written_file();
  CaseFile cases(file, plan, std::move(out).value());
  if (Status written = cases.out_->write(cases_text(plan, results)); !written) return written.error();
  if (Status flushed = cases.out_->flush(); !flushed) return flushed.error();
  // All that the other files have is in the new one now.
  std::error_code ignored;
  for (const std::filesystem::path& other : list_case_files(folder)) {
    if (other != growing) std::filesystem::remove(other, ignored);
  }
  if (restarts) std::filesystem::remove_all(parts_folder(folder), ignored);
  cases.results_ = std::move(results);
  return cases;
}

Status CaseFile::add(const StudyCase& study_case, const CaseResult& result) {
  DoneCase done{study_case, result};
  if (Status written = out_->write(case_line(done)); !written) return written;
  results_.insert_or_assign(case_key(study_case), std::move(done));
  return {};
}

Status CaseFile::finish() {
  if (Status committed = out_->commit(); !committed) return committed;
  out_.reset();
  return write_file(file_, cases_text(plan_, results_), Durability::now, {NamedBy::program, false});
}

}  // namespace spoonbill
