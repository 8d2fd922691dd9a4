// A shape that closes as one watertight mesh: faces share the points of the edges between them.
#pragma once

#include <TopoDS_Shape.hxx>
#include <optional>

#include "engine/exchange/cad_solid.h"

namespace spoonbill {

struct ShapeMesh {
  TriangleMesh mesh;
  double chord_error_m = 0.0;  // as a CadSolid has it
};

// By OpenCASCADE's mesher, ever finer until samples of faces and edges are within the chord error, to which
// `gap_m`, the widest between two faces, adds: a point that both have can be on one of them alone. Nothing
// where no mesh is found of whose edges each is in two triangles, once each way round. Refused: more
// triangles than the limit.
Result<std::optional<ShapeMesh>> shape_mesh(const TopoDS_Shape& shape, const SolidMeshing& meshing,
                                            double gap_m);

}  // namespace spoonbill
