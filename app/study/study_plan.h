// The plan of a study: spoons, foods, and what is varied. Plain data, made from a study file or from
// defaults.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/body.h"
#include "engine/trial/bowl.h"

namespace spoonbill {

// A spoon as the trials use it: one body, opening upwards, with the bowl found on it.
struct StudySpoon {
  std::string name;  // that of the file, without ending
  std::filesystem::path file;
  Body body;
  Bowl bowl;
};

// Food of the trials: its shape at its size, with its material.
struct StudyFood {
  std::string name;
  Body body;
};

// A thing that is varied alone, with all else as usual.
enum class StudyFactor { helping, stiffness, depth, width, curvature, pitch };
inline constexpr const char* study_factor_names[] = {"helping",    "stiffness",      "bowl_depth",
                                                     "bowl_width", "bowl_curvature", "pitch_deg"};
struct StudyVariation {
  StudyFactor factor = StudyFactor::helping;
  std::vector<double> values;
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
  double usual_friction = 0.1;             // at which variations are tried
  std::vector<StudyVariation> variations;  // on the first spoon, with the first food
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
inline constexpr Range<double> study_friction_range{0.0, 2.0};

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
//    "claim": true,  "repeats": true,  "frames_deg": [0, 10, 20],
//    "materials": ["polypropylene", "steel-304"],
//    "wrist_deg": [-20, 5],
//    "ratings": [{"spoon": "spoon-bent", "by": "a therapist", "rating": 6, "note": "easy to hold"}]}
//
// Every field but the version is optional. "shape" is a document whose first body is the food's shape;
// without it, the food is a rounded helping. A yield strain makes the food yield. An empty `file` stands for
// the defaults. Errors name the file and the field: an unknown field, an empty or descending list, a missing
// model, and a spoon without a bowl or with another name than plain text.
Result<StudyPlan> make_study_plan(const std::vector<std::filesystem::path>& spoons,
                                  const std::filesystem::path& file);

// Returns the values that identify a plan: if they are equal, so are the results of its cases.
Json plan_to_json(const StudyPlan& plan);

}  // namespace spoonbill
