// The spoons and the food of trials, as files describe them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/field_reader.h"
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

inline constexpr Range<double> study_friction_range{0.0, 2.0};

// Reads a material that comes with the program.
Result<Material> read_named_material(const std::string& name);

// Reads the document of a spoon, and finds its bowl. The body is fixed; loads, supports, regions, hand and
// motion are left out. Refuses a document with several bodies or with a body that is not bounded by one
// closed surface, a bowl that would hold no water, and a long file name.
Result<StudySpoon> read_spoon(const std::filesystem::path& file);

// Reads food, as in StudyPlan's files. The file of a shape is relative to `folder`. The reader has the error
// if a field is wrong.
Result<StudyFood> read_food(FieldReader reader, const std::filesystem::path& folder);

// Returns the food of a study without a file: gelatin that is elastic, and gelatin that yields.
Result<std::vector<StudyFood>> read_usual_foods();

}  // namespace spoonbill
