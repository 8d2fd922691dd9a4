#include "app/study/case_file.h"

#include <string>
#include <utility>

namespace spoonbill {
namespace {

constexpr int file_version = 1;
constexpr std::size_t file_limit_bytes = std::size_t{256} << 20;

std::string first_line(const Json& plan) {
  return Json{{"spoonbill_study_cases", file_version}, {"plan", plan}}.dump() + "\n";
}

std::string case_line(const DoneCase& done) {
  return Json{{"case", case_to_json(done.study_case)}, {"result", result_to_json(done.result)}}.dump() + "\n";
}

}  // namespace

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
  for (const char* const name : {"cases.jsonl", "cases.jsonl.part"}) {
    const std::filesystem::path file = folder / name;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored) || std::filesystem::file_size(file, ignored) == 0) {
      continue;
    }
    auto read = read_cases(file, plan);
    if (!read) return read;
    results.merge(read.value());
  }
  return results;
}

Result<CaseFile> CaseFile::open(const std::filesystem::path& folder, const Json& plan, bool starts_anew) {
  const std::filesystem::path file = folder / "cases.jsonl";
  CaseResults results;
  if (!starts_anew) {
    auto read = read_done_cases(folder, plan);
    if (!read) return read.error();
    results = std::move(read).value();
  }
  auto out = OutputFile::create_growing(file, {NamedBy::program, false});
  if (!out) return out.error();
  const std::filesystem::path aside = out->kept_aside();
  CaseFile cases(file, plan, std::move(out).value());
  if (Status written = cases.out_->write(cases_text(plan, results)); !written) return written.error();
  if (Status flushed = cases.out_->flush(); !flushed) return flushed.error();
  std::error_code ignored;
  if (!aside.empty()) std::filesystem::remove(aside, ignored);
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
