// Regions of a body as reports show them.
#pragma once

#include <string>

#include "engine/material/lattice_materials.h"

namespace spoonbill {

// "silicone-soft, friction 0.9": of a friction without a material, "friction 0.9".
std::string made_of_text(const MaterialRegion& region);
// "50 to 100 % along, 0 to 2.0 mm deep": what is all of the body is left out.
std::string position_text(const BodyRegion& region);

}  // namespace spoonbill
