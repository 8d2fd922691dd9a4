// The global section of IGES files (IGES 5.3, section 2.2.4.3), of which OpenCASCADE does not tell what is
// missing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace spoonbill {

// Its parameters as they stand in the file, empty where left out; at most as many as the standard has, from a
// section of reasonable length. None of what is no IGES file.
std::vector<std::string> iges_global_parameters(const std::filesystem::path& file);

// Whether it has the flag of a unit or, in its place, a unit's name, of those that the standard knows.
bool declares_iges_unit(const std::filesystem::path& file);

// How many units of the model stand for one of the real thing; 1 where that is not said.
double iges_model_scale(const std::filesystem::path& file);

}  // namespace spoonbill
