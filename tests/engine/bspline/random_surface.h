// Random knots, surfaces and parameters, the same on every machine.
#pragma once

#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "tests/engine/random.h"

namespace spoonbill {

enum class KnotKind { clamped, unclamped, periodic };

// Returns a knot vector of 1 to 6 spans whose lengths differ up to fivefold. A third of the inner knots and
// of the periodic seams have a multiplicity of up to the degree. A periodic knot vector may have fewer
// control points than degree + 1.
KnotVector random_knots(Random& random, int degree, KnotKind kind);
KnotVector random_knots(Random& random);

// Returns a surface whose control points are on a jittered sheet of about 1 x 1 m, 0.5 m high. It has a
// normal nearly everywhere.
Surface random_surface(Random& random, KnotVector u, KnotVector v);
Surface random_surface(Random& random);

// Returns sorted parameters in the domain, including both ends.
std::vector<double> random_parameters(Random& random, const KnotVector& knots, int count);

}  // namespace spoonbill
