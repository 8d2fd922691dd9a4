#include "engine/study/shell_mass.h"

#include "engine/study/curvature_range.h"
#include "engine/study/piece_quadrature.h"

namespace spoonbill {

ShellMass shell_mass(const Surface& surface, double thickness_m) {
  const PieceQuadrature in_u = piece_quadrature(surface.u, 2 * surface.u.degree() + 1);
  const PieceQuadrature in_v = piece_quadrature(surface.v, 2 * surface.v.degree() + 1);
  const Vector3 origin = surface.net.point(0, 0);
  const double t = thickness_m;
  ShellMass mass;
  for (std::size_t i = 0; i < in_u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < in_v.parameters.size(); ++j) {
      const SurfacePoint point = evaluate(surface, in_u.parameters[i], in_v.parameters[j]);
      const auto curvatures = principal_curvatures(point);
      if (!curvatures) continue;
      const Vector3 normal = point.du.cross(point.dv);
      const double area = in_u.weights[i] * in_v.weights[j] * normal.norm();
      const double mean = 0.5 * (curvatures->smallest + curvatures->largest);
      const double gaussian = curvatures->smallest * curvatures->largest;
      // The integrals of the area, and of the depth over it, from the surface to the thickness.
      const double volume = area * t * (1.0 - mean * t + gaussian * t * t / 3.0);
      const double depth = area * t * t * (0.5 - 2.0 / 3.0 * mean * t + 0.25 * gaussian * t * t);
      mass.volume_m3 += volume;
      mass.middle_m += volume * (point.position_m - origin) - depth * normal.normalized();
    }
  }
  if (mass.volume_m3 != 0.0) mass.middle_m = origin + mass.middle_m / mass.volume_m3;
  return mass;
}

}  // namespace spoonbill
