// Our surfaces as OpenCASCADE's and back, exactly. Lengths of theirs are millimetres.
#pragma once

#include <Geom_BSplineSurface.hxx>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

inline constexpr double millimetres_per_metre = 1e3;

// Both directions open and clamped: a periodic one is opened at its seam by knot insertion, an open one that
// is not clamped gets the knots at its ends. Refused: knots that OpenCASCADE holds for one.
Result<opencascade::handle<Geom_BSplineSurface>> to_occt(const Surface& surface);

// Of a surface that is neither rational nor periodic. Refused: a degree above ours, coordinates or knots that
// are no surface of ours.
Result<Surface> from_occt(const Geom_BSplineSurface& surface);

}  // namespace spoonbill
