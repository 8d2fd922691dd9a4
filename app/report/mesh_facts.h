// What there is to say about a mesh that was read and cleaned.
#pragma once

#include <string>

#include "app/files/length_unit.h"
#include "app/report/fact_sheet.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Under the field: the unit taken, the size found, what cleaning did, and what it is a body of. `whose`
// follows each label, as " of A" where there are two meshes.
void add_mesh_facts(FactSheet& facts, const LengthUnit& unit, const CleanMesh& mesh, double sheet_thickness_m,
                    const std::string& field = "mesh", const std::string& whose = "");

}  // namespace spoonbill
