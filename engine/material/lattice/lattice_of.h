// The lattice of a body of a scene: of a solid, or of a shell.
#pragma once

#include "engine/base/result.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// At rest. Fails as solid_lattice() and shell_lattice() do. `watch` is told how a feature map comes along.
Result<LatticeMesh> lattice_of(const Body& body, const FeatureMapWatch& watch = {});

}  // namespace spoonbill
