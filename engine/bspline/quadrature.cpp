#include "engine/bspline/quadrature.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"

namespace spoonbill {
namespace {

struct Quadrature {
  std::vector<double> nodes, weights;  // nodes and weights for the interval from -1 to 1
};

// Returns the Gauss-Legendre rule with `count` nodes. The nodes are the roots of the Legendre polynomial,
// found by Newton's method from Tricomi's estimate.
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

PieceQuadrature make_piece_quadrature(const KnotVector& knots, int nodes) {
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

namespace {

using Parameters = Eigen::Vector2d;

void visit_whole_surface(const Surface& surface, const AreaVisitor& visit) {
  const PieceQuadrature in_u = make_piece_quadrature(surface.u, 2 * surface.u.degree() + 1);
  const PieceQuadrature in_v = make_piece_quadrature(surface.v, 2 * surface.v.degree() + 1);
  for (std::size_t i = 0; i < in_u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < in_v.parameters.size(); ++j) {
      visit(evaluate(surface, in_u.parameters[i], in_v.parameters[j]), in_u.weights[i] * in_v.weights[j]);
    }
  }
}

// Visits the seven points of Radon's rule in a triangle of parameters: the centroid and, at each of two
// distances from it, three points on the medians.
void visit_triangle(const Surface& surface, const std::array<Parameters, 3>& corners,
                    const AreaVisitor& visit) {
  const Parameters first = corners[1] - corners[0], second = corners[2] - corners[0];
  const double size = 0.5 * (first.x() * second.y() - first.y() * second.x());
  if (!(size > 0.0)) return;
  const double root = std::sqrt(15.0);
  const Parameters centroid = (corners[0] + corners[1] + corners[2]) / 3.0;
  visit(evaluate(surface, centroid.x(), centroid.y()), 9.0 / 40.0 * size);
  for (const double sign : {-1.0, 1.0}) {
    const double fraction = (6.0 + sign * root) / 21.0, weight = (155.0 + sign * root) / 1200.0;
    for (const Parameters& corner : corners) {
      const Parameters point = 3.0 * fraction * centroid + (1.0 - 3.0 * fraction) * corner;
      visit(evaluate(surface, point.x(), point.y()), weight * size);
    }
  }
}

}  // namespace

void visit_area(const Surface& surface, const TrimmedArea& area, const AreaVisitor& visit) {
  SPOONBILL_ASSERT(static_cast<bool>(visit));
  if (area.is_whole()) return visit_whole_surface(surface, visit);
  const std::vector<double> u = nested_parameters(surface.u, 1, 1).parameters;
  const std::vector<double> v = nested_parameters(surface.v, 1, 1).parameters;
  const auto grid = make_grid(surface.u, surface.v, u, v);
  if (!grid) return visit_whole_surface(surface, visit);
  const TrimmedGrid trimmed = trim_grid(grid->u, grid->v, area);
  const auto parameters_at = [&](std::uint32_t vertex) -> Parameters {
    const std::size_t samples = u.size() * v.size();
    if (vertex < samples) return {u[vertex / v.size()], v[vertex % v.size()]};
    const CutVertex& cut = trimmed.vertices[vertex - samples];
    return {cut.u, cut.v};
  };
  for (const auto& [a, b, c] : trimmed.triangles)
    visit_triangle(surface, {parameters_at(a), parameters_at(b), parameters_at(c)}, visit);
}

}  // namespace spoonbill
