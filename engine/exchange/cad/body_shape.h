// A surface as a shape of OpenCASCADE: a closed solid where it closes, an open shell where not
// or where it is trimmed. Lengths are millimetres.
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
  std::vector<TopoDS_Face> faces;  // their normals are the surface's
  bool was_cut = false;            // in two parts, which the faces are of
};

// What the trims keep of a surface. Refused: as body_shape() does.
Result<PartFaces> faces_of(const CadSurface& part);

TopoDS_Shell shell_of(const TopoDS_Face& face);

// A trimmed surface is one shell, or a compound of one for each of its islands.
//
// A side whose control points coincide is a pole of the body, two opposite sides that coincide are its seam;
// it is closed when every side is one or the other. The faces of what closes, trimmed or not, turn their
// outsides outwards, whichever way the surface's normals point. A face of a solid is a shell, as it is.
// Refused: a surface or trim loops of which OpenCASCADE can build no valid shape.
Result<BodyShape> body_shape(const CadSurface& part);

}  // namespace spoonbill
