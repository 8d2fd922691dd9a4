#include "engine/study/enclosed_mass.h"

#include <cmath>
#include <numbers>
#include <vector>

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
      if (count == 1) before = 1.0;
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

struct ParameterSums {
  std::vector<double> parameters, weights;
};

// The first moment of the volume is of degree 4 p - 1 in a direction of degree p, and n nodes are exact to
// 2 n - 1.
ParameterSums quadrature_over(const KnotVector& knots) {
  const Quadrature rule = gauss_legendre(2 * knots.degree() + 1);
  const std::vector<double> pieces = knots.breakpoints();
  ParameterSums result;
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    const double half = 0.5 * (pieces[k + 1] - pieces[k]);
    for (std::size_t n = 0; n < rule.nodes.size(); ++n) {
      result.parameters.push_back(pieces[k] + half * (1.0 + rule.nodes[n]));
      result.weights.push_back(half * rule.weights[n]);
    }
  }
  return result;
}

}  // namespace

EnclosedMass enclosed_mass(const Surface& surface) {
  const ParameterSums in_u = quadrature_over(surface.u), in_v = quadrature_over(surface.v);
  // From a point of the body, so that digits are not lost to where it lies.
  const Vector3 origin = surface.net.point(0, 0);
  EnclosedMass mass;
  for (std::size_t i = 0; i < in_u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < in_v.parameters.size(); ++j) {
      const SurfacePoint point = evaluate(surface, in_u.parameters[i], in_v.parameters[j]);
      const Vector3 place = point.position_m - origin;
      const Vector3 normal = in_u.weights[i] * in_v.weights[j] * point.du.cross(point.dv);
      const double area = normal.norm(), cone = place.dot(normal) / 3.0;
      mass.area_m2 += area;
      mass.area_middle_m += area * place;
      mass.volume_m3 += cone;
      mass.middle_m += 0.75 * cone * place;  // a cone's middle is three quarters from its tip
    }
  }
  if (mass.area_m2 > 0.0) mass.area_middle_m = origin + mass.area_middle_m / mass.area_m2;
  if (mass.volume_m3 != 0.0) mass.middle_m = origin + mass.middle_m / mass.volume_m3;
  return mass;
}

}  // namespace spoonbill
