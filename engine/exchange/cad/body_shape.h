// Construction of OpenCASCADE shapes from surfaces with trim loops. Lengths are millimetres.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Shell.hxx>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct BodyShape {
  TopoDS_Shape shape;
  bool solid = false;
};

struct PartFaces {
  std::vector<TopoDS_Face> faces;  // with the normals of the surface
  bool was_cut = false;  // true if the surface was divided into two parts; `faces` has the faces of both
};

// Builds the faces of the part of a surface that remains after trimming. Each trim loop is divided into edges
// at its corners. A surface that closes and has only holes is divided into two parts, because CAD systems do
// not support a face between poles without an outer edge. A face that OpenCASCADE rejects is repaired, and
// may become several. Fails for the same reasons as build_body_shape().
Result<PartFaces> build_faces(const CadSurface& part);

// Returns the volume that a closed shell encloses, to about 1 %; negative if its normals point inwards.
double measure_volume_mm3(const TopoDS_Shape& shell);

// Returns a shell of one face.
TopoDS_Shell make_shell(const TopoDS_Face& face);

// Builds a solid from a surface that closes, otherwise an open shell. A trimmed surface becomes one shell, or
// a compound with one shell for each connected component.
//
// A side whose control points coincide is a pole of the body; two opposite sides that coincide are its seam.
// The surface closes if every side is a pole or part of a seam. Faces of a surface that closes, trimmed or
// not, have outward normals, whatever the direction of the surface's normals. A surface that is one face of a
// solid becomes a shell and keeps its orientation. Refused: a surface or trim loops from which OpenCASCADE
// cannot build a valid shape, and loops that leave no position for a seam or for the cut into two parts.
Result<BodyShape> build_body_shape(const CadSurface& part);

}  // namespace spoonbill
