// Approximation of any OpenCASCADE surface by a B-spline surface within a tolerance. The B-spline
// interpolates the surface at the Greville parameters, and has more control points where the error would be
// too large.
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
  Surface surface;  // has the parameters of the original
  // Largest distance from the original at equal parameters, in metres. It is checked at 9 x 9 parameters in
  // each rectangle between knots.
  double deviation_m = 0.0;
};

// Approximates the part of a surface over a box. `scale` is the length of one unit of the surface in metres.
// The result is cubic, or of degree 5 or 7 if the lower degrees need too many control points. A direction
// becomes periodic if the surface has the same points at the start and the end of the box. Refused: a
// tolerance that needs more control points than a surface may have, a surface that is not finite.
Result<PatchFit> approximate_patch(const opencascade::handle<Geom_Surface>& surface, const ParameterBox& box,
                                   double scale, double tolerance_m);

}  // namespace spoonbill
