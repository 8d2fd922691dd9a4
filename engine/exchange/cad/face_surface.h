// The surface under a face of a CAD file as one of ours: a spline with trim loops is whole, all others are
// cut to the face's range of parameters.
#pragma once

#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct FaceSurface {
  Surface surface;              // metres, normals out of the face
  double deviation_m = 0.0;     // 0 where it was taken as it stands
  std::vector<TrimLoop> trims;  // where the face is less than its range of parameters
  std::string trim_problem;     // why there are none although it is
};

// B-spline and Bezier surfaces, planes and extrusions of such curves are taken exactly; whatever is rational,
// of a higher degree than ours, or no spline at all is approximated. `scale` is metres for each unit of the
// face. Refused: a face without a surface, or of no finite extent; a tolerance that asks for too many control
// points.
Result<FaceSurface> face_surface(const TopoDS_Face& face, double scale, double tolerance_m);

}  // namespace spoonbill
