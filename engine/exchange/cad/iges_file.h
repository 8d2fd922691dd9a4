// Checks of IGES files (IGES 5.3, section 2.2) that OpenCASCADE does not make. OpenCASCADE reports neither
// missing parameters nor missing lines, and returns 0 for numbers that it does not find.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/result.h"

namespace spoonbill {

// Returns the parameters of the global section (IGES 5.3, section 2.2.4.3) as text; a missing parameter is an
// empty text. Returns at most as many parameters as the standard has, from a section of at most 2000 lines.
// Returns an empty list for a file that is not IGES.
std::vector<std::string> read_iges_global_parameters(const std::filesystem::path& file);

// Returns true if the global section has a known flag or name of a unit.
bool declares_iges_unit(const std::filesystem::path& file);

// Returns the scale of the model: its size divided by the size of the real object; default: 1.
double iges_model_scale(const std::filesystem::path& file);

// Returns the number of directory entries without a type; such entries are ignored. Refused: a file without
// its last line, with more or fewer lines than its last line states, or with entities whose parameters would
// be beyond its end. A file without a directory is accepted here; OpenCASCADE decides about it.
Result<int> count_null_entities(const std::filesystem::path& file);

}  // namespace spoonbill
