// The page of a person's progress: the score of attempt after attempt, for each task.
#pragma once

#include <string>

#include "app/training/person_log.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the page, which needs no other file and no network. Errors: those of make_page().
Result<std::string> make_progress_page(const std::string& person, const LoggedAttempts& logged);

}  // namespace spoonbill
