// Approximation of any OpenCASCADE surface by a B-spline surface within a tolerance: interpolated at the
// Greville parameters, with more control points where the error is too large.
#pragma once

#include <Geom_Surface.hxx>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Rectangle of parameters (u, v) of a surface.
struct ParameterBox {
  double u_start = 0.0, u_end = 0.0, v_start = 0.0, v_end = 0.0;
};

struct PatchFit {
  Surface surface;  // surface with the parameters of the original
  // Largest distance at equal parameters, in metres, checked at 9 x 9 positions in each piece.
  double deviation_m = 0.0;
};

// Approximates the part of a surface over a box. `scale` is the length of one unit of the surface in metres.
// The result is cubic, or of degree 5 or 7 where the lower degrees need too many control points. A direction
// whose box is a whole period, or whose ends meet, becomes periodic. Refused: a tolerance that needs more
// control points than a surface may have, a surface that is not finite.
Result<PatchFit> approximate_patch(const opencascade::handle<Geom_Surface>& surface, const ParameterBox& box,
                                   double scale, double tolerance_m);

}  // namespace spoonbill
