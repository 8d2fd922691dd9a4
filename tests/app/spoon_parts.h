// Models shared by the tests of the merge and change commands.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "engine/exchange/document.h"

namespace spoonbill {

inline const std::string handle = SPOONBILL_ASSETS "/models/spoon-handle.json";
inline const std::string bowl = SPOONBILL_ASSETS "/models/spoon-bowl.json";

inline Surface surface_of(const std::filesystem::path& file, std::size_t body = 0) {
  return read_document(file).value().scene.bodies[body].surface;
}

}  // namespace spoonbill
