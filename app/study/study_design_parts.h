// Sections of the page of a study that show its designs: the full grid, drawn cases and the sensitivity
// analysis.
#pragma once

#include <string>

#include "app/study/study_summary.h"

namespace spoonbill {

// Each returns a section, or an empty text if the plan has no such design.
std::string grid_part(const StudyPlan& plan, const StudySummary& summary);
std::string sample_part(const StudyPlan& plan, const CaseResults& results);
std::string sensitivity_part(const StudyPlan& plan, const StudySummary& summary);

// Returns a factor in words, such as "bowl depth".
std::string factor_text(StudyFactor factor);

}  // namespace spoonbill
