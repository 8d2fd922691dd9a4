// The solids that are joined of a model's faces, as watertight meshes.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad/cad_writer.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/cad_solid.h"

namespace spoonbill {

// Of the surfaces that name a solid, as write_cad() joins them; every one is loose that does not. Those of
// which OpenCASCADE makes no solid, or none with a mesh, are loose, and a note says so. prepare_occt() must
// have been called. Refused: more triangles than the limit.
Result<CadSolids> mesh_solids(const CadModel& model, const SolidMeshing& meshing,
                              const Progress& progress = {});

}  // namespace spoonbill
