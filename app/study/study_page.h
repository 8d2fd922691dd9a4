// The report of a study: one HTML page that needs no other file and no network.
#pragma once

#include <string>
#include <vector>

#include "app/study/study_summary.h"
#include "app/study/study_tables.h"
#include "engine/base/result.h"

namespace spoonbill {

// A picture of the end of a case, and a video of all of it.
struct StudyPicture {
  StudyCase study_case;
  std::string verdict;  // in words, or the reason why the case was not judged
  std::string png;      // bytes of the file; empty if there is no picture
  std::string video;    // bytes of an MP4 file of the case; empty without ffmpeg
};

// Returns the page. Its style and its script come with the program; the error names a file that is missing.
// Fails if a spoon encloses no volume.
Result<std::string> make_study_page(const StudyPlan& plan, const CaseResults& results,
                                    const StudySummary& summary, const Bendings& bendings,
                                    const std::vector<StudyPicture>& pictures);

}  // namespace spoonbill
