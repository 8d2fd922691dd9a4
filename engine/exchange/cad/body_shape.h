// A surface as a shape of OpenCASCADE: a closed solid where it closes, an open shell where not
// or where it is trimmed. Lengths are millimetres.
#pragma once

#include <TopoDS_Shape.hxx>

#include "engine/exchange/cad_model.h"
#include "engine/result.h"

namespace spoonbill {

struct BodyShape {
  TopoDS_Shape shape;
  bool solid = false;
};

// A trimmed surface is one shell, or a compound of one for each of its islands.
//
// A side whose control points coincide is a pole of the body, two opposite sides that coincide are its seam;
// it is closed when every side is one or the other. The faces of what closes, trimmed or not, turn their
// outsides outwards, whichever way the surface's normals point. Refused: a surface or trim loops of which
// OpenCASCADE can build no valid shape.
Result<BodyShape> body_shape(const CadSurface& part);

}  // namespace spoonbill
