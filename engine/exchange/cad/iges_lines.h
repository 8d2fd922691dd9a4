// The lines of IGES files (IGES 5.3, section 2.2), of which OpenCASCADE does not tell when some are missing:
// it takes 0 for each number that it does not find.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

// How many entries of its directory are of no type, which stand for nothing. Refused: a file without its last
// line, with more or fewer lines than that counts, or with entities whose parameters would lie beyond its
// end. What has no directory of entities is left to OpenCASCADE to judge.
Result<int> count_null_entities(const std::filesystem::path& file);

}  // namespace spoonbill
