// What a body of several materials weighs. Pure functions, outside the tick; any thread.
#pragma once

#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct MaterialMix {
  double density_kg_per_m3 = 0.0;           // the mean over the body
  Vector3 from_middle_m = Vector3::Zero();  // from the middle of its volume to that of its mass
  std::vector<std::string> materials;       // the names of those that it holds, its own first
};

// By the cells of the body's lattice, each of the material that its regions give it. Refused: what has no
// lattice, and what lattice_materials() refuses.
Result<MaterialMix> material_mix(const Body& body);

}  // namespace spoonbill
