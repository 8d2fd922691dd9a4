#include "engine/study/enclosed_mass.h"

#include "engine/study/piece_quadrature.h"

namespace spoonbill {

EnclosedMass enclosed_mass(const Surface& surface) {
  // The first moment of the volume is of degree 4 p - 1 in a direction of degree p.
  const PieceQuadrature in_u = piece_quadrature(surface.u, 2 * surface.u.degree() + 1);
  const PieceQuadrature in_v = piece_quadrature(surface.v, 2 * surface.v.degree() + 1);
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
