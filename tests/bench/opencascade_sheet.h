// Converts our clamped sheets to OpenCASCADE's surfaces.
#pragma once

#include <Geom_BSplineSurface.hxx>

#include "engine/bspline/surface.h"

namespace spoonbill {

// Converts a sheet, which must be clamped in both directions.
opencascade::handle<Geom_BSplineSurface> opencascade_sheet(const Surface& sheet);

}  // namespace spoonbill
