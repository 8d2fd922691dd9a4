// The plan of a study: spoons, foods, and what is varied. Plain data, made from a study file or from
// defaults.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/study/spoons_and_foods.h"
#include "app/study/study_case.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/body.h"
#include "engine/trial/bowl.h"

namespace spoonbill {

// Values of a factor, other than friction and tilt, which have lists of their own.
struct StudyVariation {
  StudyFactor factor = StudyFactor::helping;
  std::vector<double> values;
};

// Range from which the values of a factor are drawn.
struct FactorRange {
  StudyFactor factor = StudyFactor::tilt;
  Range<double> range{0.0, 0.0};
};

// A design of cases that are drawn from ranges, on the first spoon with the first food.
enum class SampleMethod { latin_hypercube, sobol };
inline constexpr const char* sample_method_names[] = {"latin_hypercube", "sobol"};
struct StudySample {
  SampleMethod method = SampleMethod::sobol;
  int count = 0;           // of cases; 0: no design
  std::uint32_t seed = 1;  // of a Latin hypercube
  std::vector<FactorRange> ranges;
};
inline constexpr Range<int> sample_count_range{2, 100'000};
inline constexpr Range<int> sensitivity_count_range{8, 10'000};

// A sensitivity analysis of the margin, on the first spoon with the first food (sampled_cases.h).
struct SensitivityPlan {
  int count = 0;  // rows N of each matrix: count (factors + 2) cases; 0: no analysis
  std::vector<FactorRange> ranges;
};

// A person's rating of a spoon, from 1 (bad) to 7 (good).
struct SpoonRating {
  std::string spoon, by, note;
  int rating = 4;
};
inline constexpr Range<int> rating_range{1, 7};

struct StudyPlan {
  std::vector<StudySpoon> spoons;
  std::vector<StudyFood> foods;
  std::vector<double> tilts_deg;  // ascending
  std::vector<double> frictions;
  double usual_friction = 0.1;  // at which variations are tried
  // Tried one value at a time on the first spoon with the first food at the usual friction, or all
  // combinations on every spoon with every food at every friction.
  std::vector<StudyVariation> variations;
  bool is_full_grid = false;
  StudySample sample;
  SensitivityPlan sensitivity;
  // True if a series tries the claim of Pungotra et al. 2013: food spills over the front of a straight spoon,
  // stays at 10 degrees and spills over the back at 20.
  bool tries_claim = true;
  bool repeats = true;  // whether changes of verdict are repeated with shorter steps and finer cells
  std::vector<double> frame_tilts_deg;  // of the pictures
  std::vector<Material> materials;      // of which the spoons are weighed and bent
  // Range of the wrist's deviation while feeding: ulnar is negative, radial is positive and lifts the front.
  Range<double> wrist_deg{-20.0, 5.0};
  std::string wrist_source;
  std::vector<SpoonRating> ratings;
};

inline constexpr Range<double> study_tilt_range_deg{-60.0, 60.0};

// Choices of a command line, which go before those of the study file.
struct StudyChoices {
  std::optional<bool> is_full_grid = {};
  int sensitivity_count = 0;  // 0: as the study file says
};

// Makes the plan of a study of these spoon files. `file` is the study file, which may set every other part of
// the plan:
//
//   {"spoonbill_study": 1,
//    "tilts_deg": [-30, -25, 0, 30],  "frictions": [0.02, 0.1, 0.3],
//    "foods": [{"name": "gelatin", "material": "gelatin-20-1", "size_mm": [28, 14, 22]},
//              {"name": "soft", "material": "gelatin-20-1", "size_mm": [28, 14, 22], "shape": "egg.json",
//               "youngs_modulus_pa": 1000, "yield_strain": 0.05}],
//    "usual_friction": 0.1,
//    "vary": {"helping": [0.8, 1.2], "stiffness": [0.5, 2], "bowl_depth": [0.7, 1.4], "bowl_width": [],
//             "bowl_curvature": [], "pitch_deg": [-10]},
//    "grid": "full",
//    "sample": {"method": "latin_hypercube", "count": 64, "seed": 1,
//               "ranges": {"friction": [0.02, 0.3], "tilt_deg": [-20, 20], "helping": [0.8, 1.2]}},
//    "sensitivity": {"count": 64, "ranges": {"friction": [0.02, 0.3], "bowl_depth": [0.7, 1.4]}},
//    "claim": true,  "repeats": true,  "frames_deg": [0, 10, 20],
//    "materials": ["polypropylene", "steel-304"],
//    "wrist_deg": [-20, 5],
//    "ratings": [{"spoon": "spoon-bent", "by": "a therapist", "rating": 6, "note": "easy to hold"}]}
//
// Every field but the version is optional. "shape" is a document whose first body is the food's shape;
// without it, the food is a rounded helping. A yield strain makes the food yield. "grid" is "one_at_a_time"
// (default) or "full". The method "sobol" has no seed. Without "ranges", a sensitivity analysis takes those
// that the lists of tilts, frictions and variations span. An empty `file` stands for the defaults; `choices`
// go before the file. Errors name the file and the field: an unknown field, an empty or descending list, a
// missing model, and a spoon without a bowl or with another name than plain text.
Result<StudyPlan> make_study_plan(const std::vector<std::filesystem::path>& spoons,
                                  const std::filesystem::path& file, const StudyChoices& choices = {});

// Returns the name of the first spoon of the plan that has the same surface and rim as the named one.
const std::string& find_first_of_shape(const StudyPlan& plan, const std::string& spoon);

// Returns a line for each food that is longer or wider than the bowl of a spoon. It lies on the rim, so that
// its verdicts say little about the bowl.
std::vector<std::string> find_large_foods(const StudyPlan& plan);

// Returns the values that identify a plan: if they are equal, so are the results of its cases.
Json plan_to_json(const StudyPlan& plan);

}  // namespace spoonbill
