// The edges of a face as trim loops over its surface.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

// A loop for each wire of the face, of cubic pieces within a millionth of the domain of the edges' curves
// over (u, v), nearer where the surface would stretch that beyond the tolerance, and exact where those are
// splines of degree 3 and less; none for a wire that runs around the whole domain. The surface has the
// parameters of the face's own. Refused: a face whose edges have no curves over its parameters or do not hang
// together, and loops that bound no area.
Result<std::vector<TrimLoop>> trims_of(const TopoDS_Face& face, const Surface& surface, double tolerance_m);

}  // namespace spoonbill
