// Gauss quadrature over surfaces. The functions are pure, may run on any thread, and are too slow for a tick.
#pragma once

#include <functional>
#include <vector>

#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

// Nodes and weights over the polynomial pieces of one direction (Gauss 1814).
struct PieceQuadrature {
  std::vector<double> parameters, weights;
};

// Returns a rule with `nodes` nodes in each polynomial piece; `nodes` must be at least 1. The rule is exact
// for polynomials up to degree 2 * nodes - 1.
PieceQuadrature make_piece_quadrature(const KnotVector& knots, int nodes);

// Function that receives a surface point and a weight. The weight is the part of the parameter domain that
// the point represents; `weight` times |du x dv| is an area.
using AreaVisitor = std::function<void(const SurfacePoint& point, double weight)>;

// Visits the quadrature points of the area within the trims. For a whole surface the rule is exact up to
// degree 4 p + 1 in a direction of degree p. A trimmed surface is divided into triangles, eight for a whole
// polynomial piece, on which the rule is exact up to degree 5 (Radon 1948); the triangles' edges approximate
// the trim loops.
void visit_area(const Surface& surface, const TrimmedArea& area, const AreaVisitor& visit);

}  // namespace spoonbill
