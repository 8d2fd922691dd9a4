// Conversion of a face of a CAD file to a surface with trim loops.
#pragma once

#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

struct FaceSurface {
  Surface surface;              // surface in metres, with the normals of the face
  double deviation_m = 0.0;     // 0 if the conversion is exact
  std::vector<TrimLoop> trims;  // empty if the face covers its whole range of parameters
  // Largest distance between the file's edges and the trim loops or, if the face is untrimmed, between the
  // file's edges and the sides of the surface.
  double trim_deviation_m = 0.0;
  std::string trim_problem;  // reason why a trimmed face has no trims; empty otherwise
};

// Converts a face. Planes, non-rational B-spline and Bezier surfaces, and extrusions of lines and of
// non-rational curves are converted exactly. All other surfaces are approximated, as are surfaces of a degree
// above max_degree or with too many control points. A trimmed B-spline surface that is not rational stays
// whole, unless the face crosses its seam. Any other surface is cut to the face's range of parameters. The
// range ends where a polynomial surface ends, even if edges overshoot this end. `scale` is the length of one
// unit of the face in metres. Refused: a face without a surface or of infinite extent, a tolerance that needs
// too many control points.
Result<FaceSurface> convert_face(const TopoDS_Face& face, double scale, double tolerance_m);

// Returns the centre of the face's edges as "(1, 2, 3) mm", so that a person can find the face. Returns an
// empty text if no edge has a curve, or if a coordinate is not finite.
std::string face_place_text(const TopoDS_Face& face, double scale);

}  // namespace spoonbill
