// Parts of the cases of a study, for programs that run on many machines: each runs its part of the cases that
// are needed next, and one merges what they have done.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "app/study/case_file.h"
#include "app/study/next_cases.h"
#include "app/study/study_plan.h"
#include "engine/base/result.h"

namespace spoonbill {

// Part `number`, from 1 to `count`, of the cases that a study needs next.
struct StudyPart {
  int number = 1, count = 1;
};
inline constexpr Range<int> part_count_range{1, 1000000};

// Returns every count-th of the cases, beginning with the part's number.
std::vector<StudyCase> cases_of_part(const StudyPart& part, const std::vector<StudyCase>& cases);

// Returns the file of a part in the folder of a study. It appears whole or not at all.
std::filesystem::path part_file(const std::filesystem::path& folder, const StudyPart& part);

// Runs a part on `workers` threads and writes its file. The cases follow from what the folder of the study
// has, so that all parts must run before any is merged.
Status run_part(const std::filesystem::path& folder, const StudyPlan& plan, const StudyPart& part,
                int workers, const std::function<bool()>& is_stopped);

// Adds all parts in the folder to the cases, and removes their files. Returns the number of cases added.
Result<std::size_t> merge_parts(const std::filesystem::path& folder, const StudyPlan& plan, CaseFile& cases);

}  // namespace spoonbill
