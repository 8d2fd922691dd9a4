#include "engine/inspection/piece_quadrature.h"

#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

struct Quadrature {
  std::vector<double> nodes, weights;  // on -1 to 1
};

// Roots of the Legendre polynomial by Newton's method from Tricomi's guess.
Quadrature gauss_legendre(int count) {
  Quadrature rule;
  for (int k = 0; k < count; ++k) {
    double x = std::cos(std::numbers::pi * (k + 0.75) / (count + 0.5)), slope = 1.0;
    for (int step = 0; step < 50; ++step) {
      double before = 1.0, value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = count * (x * value - before) / (x * x - 1.0);
      const double move = value / slope;
      x -= move;
      if (std::abs(move) < 1e-15) break;
    }
    rule.nodes.push_back(x);
    rule.weights.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

PieceQuadrature piece_quadrature(const KnotVector& knots, int nodes) {
  SPOONBILL_ASSERT(nodes >= 1);
  const Quadrature rule = gauss_legendre(nodes);
  const std::vector<double> pieces = knots.breakpoints();
  PieceQuadrature result;
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    const double half = 0.5 * (pieces[k + 1] - pieces[k]);
    for (std::size_t n = 0; n < rule.nodes.size(); ++n) {
      result.parameters.push_back(pieces[k] + half * (1.0 + rule.nodes[n]));
      result.weights.push_back(half * rule.weights[n]);
    }
  }
  return result;
}

}  // namespace spoonbill
