// Whether a mesh that is a text is cut short: Assimp takes what is left of it for the whole.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

// The Errors say what is wrong, without the file's name.

// A text of an STL file ends with the line `endsolid`, of which it may lack the name and the line's end.
// Nothing is said of a binary one, whose length tells Assimp that it is whole.
Status check_text_stl(const std::filesystem::path& file);

// The last line of an OBJ file, where nothing ends it, has all the numbers of a vertex, or three corners or
// more of a face, all of one form. Cut between two lines, or within the last number, a file cannot be told.
Status check_last_obj_line(const std::filesystem::path& file);

}  // namespace spoonbill
