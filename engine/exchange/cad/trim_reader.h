// Reader of the loops that trim a face of a CAD file, over the parameters of its surface.
#pragma once

#include <TopoDS_Face.hxx>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

struct FaceTrims {
  std::vector<TrimLoop> loops;
  // Largest distance between the loops on the surface and the 3D curves of the file's edges, measured at
  // samples of the loops.
  double deviation_m = 0.0;
};

// Returns a loop for each wire of the face except wires around the whole domain. `surface` is the surface of
// the face, in metres, over the face's own parameters. `scale` is the length of one unit of the face in
// metres. The cubic pieces of a loop deviate from the edges' curves by at most a millionth of the domain, or
// less if a millionth would exceed the tolerance on the surface. Curves of degree 3 and less that are not
// rational are converted exactly. The parts of a curve beyond an open end of the domain are moved to that
// end. Refused: edges that have no curves over the parameters or are not connected, and loops that bound no
// area.
Result<FaceTrims> read_trim_loops(const TopoDS_Face& face, const Surface& surface, double scale,
                                  double tolerance_m);

// Returns the largest distance, in metres, between the 3D curves of an untrimmed face's edges and the sides
// of its surface.
double measure_sides(const TopoDS_Face& face, const Surface& surface, double scale, double tolerance_m);

}  // namespace spoonbill
