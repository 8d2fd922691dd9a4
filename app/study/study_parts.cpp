#include "app/study/study_parts.h"

#include <algorithm>
#include <string>
#include <utility>

#include "app/study/case_crew.h"
#include "engine/base/file.h"

namespace spoonbill {
std::vector<StudyCase> cases_of_part(const StudyPart& part, const std::vector<StudyCase>& cases) {
  std::vector<StudyCase> own;
  for (auto k = static_cast<std::size_t>(part.number - 1); k < cases.size();
       k += static_cast<std::size_t>(part.count)) {
    own.push_back(cases[k]);
  }
  return own;
}

std::filesystem::path part_file(const std::filesystem::path& folder, const StudyPart& part) {
  return parts_folder(folder) /
         ("part-" + std::to_string(part.number) + "-of-" + std::to_string(part.count) + ".jsonl");
}

Status run_part(const std::filesystem::path& folder, const StudyPlan& plan, const StudyPart& part,
                int workers, const std::function<bool()>& is_stopped) {
  const Json identity = plan_to_json(plan);
  const auto known = read_done_cases(folder, identity);
  if (!known) return known.error();
  const std::vector<StudyCase> cases = cases_of_part(part, find_next_cases(plan, known.value()));
  CaseResults done;
  const auto receive = [&](const StudyCase& study_case, const CaseResult& result) -> Status {
    done.insert_or_assign(case_key(study_case), DoneCase{study_case, result});
    return {};
  };
  if (Status ran = run_cases(plan, cases, workers, receive, is_stopped); !ran) return ran;
  std::error_code failure;
  std::filesystem::create_directories(parts_folder(folder), failure);
  return write_file(part_file(folder, part), cases_text(identity, done), Durability::now,
                    {NamedBy::program, false});
}

Result<std::size_t> merge_parts(const std::filesystem::path& folder, const StudyPlan& plan, CaseFile& cases) {
  const Json identity = plan_to_json(plan);
  std::vector<std::filesystem::path> files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(parts_folder(folder), failure)) {
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::size_t added = 0;
  for (const std::filesystem::path& file : files) {
    const auto done = read_cases(file, identity);
    if (!done) return done.error();
    for (const auto& [key, one] : done.value()) {
      if (cases.results().contains(key)) continue;
      if (Status kept = cases.add(one.study_case, one.result); !kept) return kept.error();
      ++added;
    }
  }
  if (Status flushed = cases.flush(); !flushed) return flushed.error();
  // A task that was killed while it wrote has left an unfinished file as well.
  std::filesystem::remove_all(parts_folder(folder), failure);
  return added;
}

}  // namespace spoonbill
