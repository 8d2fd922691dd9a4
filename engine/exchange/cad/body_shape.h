// A surface as a shape of OpenCASCADE: a closed solid where it closes, an open shell of one face where not.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Shape.hxx>

#include "engine/result.h"

namespace spoonbill {

struct BodyShape {
  TopoDS_Shape shape;
  bool solid = false;
};

// `surface` open and clamped in both directions, in millimetres. A side whose poles coincide is a pole of the
// body, two opposite sides that coincide are its seam; it is closed when every side is one or the other. A
// solid's face turns its outside outwards, whichever way the surface's normals point. Refused: a surface on
// which OpenCASCADE can build no valid shape.
Result<BodyShape> body_shape(const opencascade::handle<Geom_BSplineSurface>& surface);

}  // namespace spoonbill
