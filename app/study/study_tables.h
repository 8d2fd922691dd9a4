// The tables of a study: all cases as CSV, and everything as JSON. Lengths in mm and masses in g in the CSV,
// SI in the JSON.
#pragma once

#include <string>

#include "app/study/spoon_bending.h"
#include "app/study/study_summary.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Returns the text of cases.csv: a row for each case in the order of the keys.
std::string cases_csv(const CaseResults& results);

// Returns the content of study.json: plan, measures of the spoons, series, repeats and the cases that could
// not be judged. Fails if a spoon encloses no volume.
Result<Json> study_json(const StudyPlan& plan, const CaseResults& results, const StudySummary& summary,
                        const Bendings& bendings);

// The tilts at which food holds, as angles of the wrist, and the part within the range of the wrist. The
// spoon tilts as the wrist deviates: radial deviation lifts the front.
struct WristReading {
  bool is_within = false;  // whether a part of the holding tilts is within the range
  Range<double> common_deg{0.0, 0.0};
};
WristReading read_as_wrist(const Range<double>& holds_deg, const StudyPlan& plan);

// The claim of Pungotra et al. 2013, section 5.2: straight, the food spills over the front; with the front
// lifted by 10 degrees it stays; by 20 degrees it spills over the back.
enum class ClaimReading { untried, reproduced, not_reproduced };
ClaimReading read_claim(const SeriesSummary& series);

}  // namespace spoonbill
