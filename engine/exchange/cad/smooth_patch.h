// Surfaces of OpenCASCADE of whatever kind as patches to approximate.
#pragma once

#include <Geom_Surface.hxx>

#include "engine/exchange/cad/approximation.h"
#include "engine/exchange/cad/face_trims.h"

namespace spoonbill {

// `scale` is metres for each unit of the surface. A direction whose box is a whole period, or whose ends
// meet, becomes periodic.
Result<PatchFit> approximate_patch(const opencascade::handle<Geom_Surface>& surface, const ParameterBox& box,
                                   double scale, double tolerance_m);

}  // namespace spoonbill
