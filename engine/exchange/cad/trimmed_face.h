// The part of a surface that trim loops keep, as faces of OpenCASCADE.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

struct TrimmedSurface {
  Surface surface;
  std::vector<TrimLoop> trims;
};

// Whether it closes: each direction is periodic, or its two ends are poles and the other is periodic.
bool has_no_edge(const Surface& surface);

// The same with the seams of periodic directions where no loop crosses them. A surface that closes and has
// nothing but holes becomes two parts of it: CAD systems know no face between poles without an outer edge.
// Refused: loops that leave no such place.
Result<std::vector<TrimmedSurface>> opened_parts(const Surface& surface, const std::vector<TrimLoop>& trims);

// A face for each outer loop, or one for the whole surface with holes in it. `geometry` is the surface, open,
// and no loop leaves its domain. An edge ends wherever its loop has a corner. Refused: loops of which
// OpenCASCADE can build no face.
Result<std::vector<TopoDS_Face>> trimmed_faces(const opencascade::handle<Geom_BSplineSurface>& geometry,
                                               const TrimmedSurface& part);

}  // namespace spoonbill
