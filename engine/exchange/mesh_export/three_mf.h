// 3MF (3D Manufacturing Format, core specification 1.3): a zip with a model in XML.
#pragma once

#include <vector>

#include "engine/exchange/mesh_export/mesh_writer.h"

namespace spoonbill {

// In millimetres. Refused: what take() refuses, and what libzip cannot pack.
Status write_three_mf(const std::vector<NamedMesh>& meshes, const TakeBytes& take);

}  // namespace spoonbill
