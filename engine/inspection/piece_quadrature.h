// Gauss quadrature over the polynomial pieces of one direction (Gauss 1814).
#pragma once

#include <vector>

#include "engine/bspline/knot_vector.h"

namespace spoonbill {

struct PieceQuadrature {
  std::vector<double> parameters, weights;
};

// So many nodes in each piece: exact up to degree 2 nodes - 1.
PieceQuadrature piece_quadrature(const KnotVector& knots, int nodes);

}  // namespace spoonbill
