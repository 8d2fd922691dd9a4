// Watertight meshes of OpenCASCADE's closed shapes.
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <optional>

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct ShapeMesh {
  TriangleMesh mesh;
  double chord_error_m = 0.0;  // see CadSolid::chord_error_m
};

// Meshes a closed shape. OpenCASCADE makes a mesh in which faces share the points of their edges, but which
// may be far from the faces; RefinableMesh then brings it within `chord_m`. Samples beside edges may be
// farther away by the gap between two faces there. Returns nullopt if OpenCASCADE makes no mesh that is
// closed. Refused: more triangles than the limit.
Result<std::optional<ShapeMesh>> mesh_shape(const TopoDS_Shape& shape, double chord_m,
                                            std::size_t triangle_limit);

}  // namespace spoonbill
