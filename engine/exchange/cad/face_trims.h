// What part of its surface a face is.
#pragma once

#include <TopoDS_Face.hxx>

namespace spoonbill {

// A range of a surface's parameters.
struct ParameterBox {
  double u_start = 0.0, u_end = 0.0, v_start = 0.0, v_end = 0.0;
};

// Whether some edge of the face leaves the sides of its box by more than `tolerance`, in the face's unit, or
// than a file rounds away, but for edges that the surface's own seam makes.
bool is_trimmed(const TopoDS_Face& face, const ParameterBox& box, double tolerance);

}  // namespace spoonbill
