// A case of a study, which is one helping on one spoon at one tilt, and what came of it. Plain data.
#pragma once

#include <optional>
#include <string>

#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/trial/bowl_change.h"
#include "engine/trial/verdict.h"

namespace spoonbill {

// Values that a case tries. Cases with equal values are the same case.
struct StudyCase {
  std::string spoon;  // name in the plan
  std::string food;   // name in the plan
  double friction = 0.1;
  double helping = 1.0;    // factor on the sizes of the food
  double stiffness = 1.0;  // factor on Young's modulus of the food
  BowlChange bowl = {};
  double pitch_deg = 0.0;      // turn of the spoon before the food is laid in; positive lifts the front
  double tilt_deg = 0.0;       // turn of the spoon with the food in it
  bool is_laid_after = false;  // whether the food is laid in after the tilt instead of before
  int step_division = 1;       // Sculpting::step_division
  int refinement = 0;          // cells that the food's lattice has more than usual along its shortest side
  friend bool operator==(const StudyCase&, const StudyCase&) = default;
};

inline constexpr Range<int> study_refinement_range{0, 2};

// A value of a case that a study varies, by its name in files.
enum class StudyFactor { helping, stiffness, depth, width, curvature, pitch, friction, tilt };
inline constexpr const char* study_factor_names[] = {"helping",    "stiffness",      "bowl_depth",
                                                     "bowl_width", "bowl_curvature", "pitch_deg",
                                                     "friction",   "tilt_deg"};
// Returns the value of a factor, to read or to set.
double& factor_of(StudyCase& study_case, StudyFactor factor);

// Returns one line that differs between different cases. It is the name of a case in files.
std::string case_key(const StudyCase& study_case);
// Returns how a case differs from a usual one in helping, stiffness, bowl, pitch and laying in, such as
// "helping 0.8, pitch -10°"; empty if it does not.
std::string variation_text(const StudyCase& study_case);

// The four sides of a rim.
enum class RimSide { front, left, back, right };
inline constexpr const char* rim_side_names[] = {"front", "left", "back", "right"};

struct CaseResult {
  // Why the trial could not be judged, such as a lattice that was lost; empty if it was judged.
  std::string failure;
  Verdict verdict = Verdict::undecided;
  double outside_kg = 0.0, left_kg = 0.0;  // mass outside the rim, and below it as well
  double food_kg = 0.0;
  std::optional<RimSide> side;          // over which the mass outside is
  double margin_m = 0.0;                // of the centre of mass to the rim, at the end
  std::optional<double> first_spill_s;  // since the turn began, or the trial if the food is laid in after it
  double largest_contact_n = 0.0;       // of the food on the spoon
  double motion_s = 0.0;                // time of the trial
  double largest_speed_m_per_s = 0.0;   // at the end
  int nodes = 0;                        // of the food's lattice
};

inline bool is_judged(const CaseResult& result) {
  return result.failure.empty();
}

Json case_to_json(const StudyCase& study_case);
Json result_to_json(const CaseResult& result);
Result<StudyCase> case_from_json(const Json& json, const std::string& source);
Result<CaseResult> result_from_json(const Json& json, const std::string& source);

}  // namespace spoonbill
