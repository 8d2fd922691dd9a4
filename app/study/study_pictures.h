// The pictures of a study: the end of a case, from the side, so that the tilt shows; and a video of the case.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "app/study/study_page.h"
#include "app/study/study_plan.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the cases of which a study makes pictures: each spoon at the plan's tilts, with the first food at
// the usual friction.
std::vector<StudyCase> list_pictured_cases(const StudyPlan& plan);

// Runs a case and paints its end. Writes a video of it, in real time, to `video` (.mp4), unless that is empty
// or ffmpeg is not installed. A case that cannot be judged or painted gives a picture without bytes, with the
// reason in `verdict`, and a video that cannot be made leaves its bytes empty. ErrorCode::cancelled if
// `is_stopped` returns true.
Result<StudyPicture> make_study_picture(const StudyPlan& plan, const StudyCase& study_case,
                                        const std::filesystem::path& video,
                                        const std::function<bool()>& is_stopped);

}  // namespace spoonbill
