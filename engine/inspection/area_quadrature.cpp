#include "engine/inspection/area_quadrature.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/inspection/piece_quadrature.h"

namespace spoonbill {

namespace {

using Parameters = Eigen::Vector2d;

void visit_whole(const Surface& surface, const AreaVisitor& visit) {
  const PieceQuadrature in_u = piece_quadrature(surface.u, 2 * surface.u.degree() + 1);
  const PieceQuadrature in_v = piece_quadrature(surface.v, 2 * surface.v.degree() + 1);
  for (std::size_t i = 0; i < in_u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < in_v.parameters.size(); ++j) {
      visit(evaluate(surface, in_u.parameters[i], in_v.parameters[j]), in_u.weights[i] * in_v.weights[j]);
    }
  }
}

// Radon's seven places: the middle, and three on the way from it to the corners, near them and across.
void visit_triangle(const Surface& surface, const std::array<Parameters, 3>& corners,
                    const AreaVisitor& visit) {
  const Parameters first = corners[1] - corners[0], second = corners[2] - corners[0];
  const double size = 0.5 * (first.x() * second.y() - first.y() * second.x());
  if (!(size > 0.0)) return;
  const double root = std::sqrt(15.0);
  const Parameters middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  visit(evaluate(surface, middle.x(), middle.y()), 9.0 / 40.0 * size);
  for (const double sign : {-1.0, 1.0}) {
    const double share = (6.0 + sign * root) / 21.0, weight = (155.0 + sign * root) / 1200.0;
    for (const Parameters& corner : corners) {
      // Shares of the other two corners are alike.
      const Parameters place = 3.0 * share * middle + (1.0 - 3.0 * share) * corner;
      visit(evaluate(surface, place.x(), place.y()), weight * size);
    }
  }
}

}  // namespace

void visit_area(const Surface& surface, const TrimmedArea& area, const AreaVisitor& visit) {
  SPOONBILL_ASSERT(static_cast<bool>(visit));
  if (area.is_whole()) return visit_whole(surface, visit);
  const std::vector<double> u = nested_parameters(surface.u, 1, 1).parameters;
  const std::vector<double> v = nested_parameters(surface.v, 1, 1).parameters;
  const auto grid = make_grid(surface.u, surface.v, u, v);
  if (!grid) return visit_whole(surface, visit);
  const TrimmedGrid kept = trim_grid(grid->u, grid->v, area);
  const auto place = [&](std::uint32_t number) -> Parameters {
    const std::size_t samples = u.size() * v.size();
    if (number < samples) return {u[number / v.size()], v[number % v.size()]};
    const CutVertex& cut = kept.vertices[number - samples];
    return {cut.u, cut.v};
  };
  for (const auto& [a, b, c] : kept.triangles) visit_triangle(surface, {place(a), place(b), place(c)}, visit);
}

}  // namespace spoonbill
