// A rectangle of a surface's parameters.
#pragma once

namespace spoonbill {

// Around cells of a grid. On a periodic direction it is the whole domain where the cells lie at both its
// ends.
struct ParameterRange {
  double u0, u1, v0, v1;
  bool holds(double u, double v) const { return u0 <= u && u <= u1 && v0 <= v && v <= v1; }
};

}  // namespace spoonbill
