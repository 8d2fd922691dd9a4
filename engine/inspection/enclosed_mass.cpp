#include "engine/inspection/enclosed_mass.h"

#include "engine/base/assert.h"
#include "engine/inspection/area_quadrature.h"

namespace spoonbill {

EnclosedMass enclosed_mass(const Surface& surface, const TrimmedArea& area) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  // From a point of the body, so that digits are not lost to where it lies.
  const Vector3 origin = surface.net.point(0, 0);
  EnclosedMass mass;
  // The first moment of the volume is of degree 4 p - 1 in a direction of degree p.
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const Vector3 place = point.position_m - origin;
    const Vector3 normal = weight * point.du.cross(point.dv);
    const double size = normal.norm(), cone = place.dot(normal) / 3.0;
    mass.area_m2 += size;
    mass.area_middle_m += size * place;
    mass.volume_m3 += cone;
    mass.middle_m += 0.75 * cone * place;  // a cone's middle is three quarters from its tip
  });
  if (mass.area_m2 > 0.0) mass.area_middle_m = origin + mass.area_middle_m / mass.area_m2;
  if (mass.volume_m3 != 0.0) mass.middle_m = origin + mass.middle_m / mass.volume_m3;
  return mass;
}

}  // namespace spoonbill
