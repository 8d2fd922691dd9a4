// A shape as a function over two parameters: what a surface is to be fitted to.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/base/pose.h"

namespace spoonbill {

// One direction of the parameters. `breaks` increase from one end of the domain to the other; between two of
// them the shape is smooth, and at each the fit puts a knot.
struct ShapeDirection {
  bool periodic = false;
  std::vector<double> breaks{0.0, 1.0};

  double start() const { return breaks.front(); }
  double end() const { return breaks.back(); }
};

// Metres; du x dv points outwards. `at` is called with parameters within the domain, must be continuous there
// and is best when a step of either parameter goes about as far everywhere.
struct ExactShape {
  ShapeDirection u, v;
  bool pole_at_start = false, pole_at_end = false;  // of v: all u are one point there
  // Up to where from the start of v, and from where on to its end, the shape lies in the plane of its pole: a
  // break; none where it does not.
  std::optional<double> flat_to = {}, flat_from = {};
  std::function<Vector3(double u, double v)> at;

  bool is_closed() const { return u.periodic && (v.periodic || (pole_at_start && pole_at_end)); }
};

}  // namespace spoonbill
