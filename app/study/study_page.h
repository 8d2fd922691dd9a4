// The report of a study: one HTML page that needs no other file and no network.
#pragma once

#include <string>
#include <vector>

#include "app/study/study_summary.h"
#include "engine/base/result.h"

namespace spoonbill {

// A picture of the end of a case.
struct StudyPicture {
  StudyCase study_case;
  std::string verdict;  // what the case says, in words
  std::string png;      // bytes of the file
  std::string file;     // name in the folder of the study
};

// Returns the page. Its style and its script come with the program; the error names a file that is missing.
// Fails if a spoon encloses no volume.
Result<std::string> make_study_page(const StudyPlan& plan, const CaseResults& results,
                                    const StudySummary& summary, const std::vector<StudyPicture>& pictures);

}  // namespace spoonbill
