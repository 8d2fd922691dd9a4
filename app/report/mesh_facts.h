// What there is to say about a mesh that was read and cleaned.
#pragma once

#include "app/files/length_unit.h"
#include "app/report/fact_sheet.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Under the field "mesh": the unit taken, the size found, what cleaning did, and what it is a body of.
void add_mesh_facts(FactSheet& facts, const LengthUnit& unit, const CleanMesh& mesh,
                    double sheet_thickness_m);

}  // namespace spoonbill
