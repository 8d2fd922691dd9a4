#include "engine/inspection/shell_mass.h"

#include "engine/base/assert.h"
#include "engine/inspection/area_quadrature.h"
#include "engine/inspection/curvature_range.h"

namespace spoonbill {

ShellMass shell_mass(const Surface& surface, double thickness_m, const TrimmedArea& area) {
  SPOONBILL_ASSERT(thickness_m > 0.0);
  const Vector3 origin = surface.net.point(0, 0);
  const double t = thickness_m;
  ShellMass mass;
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const auto curvatures = principal_curvatures(point);
    if (!curvatures) return;
    const Vector3 normal = point.du.cross(point.dv);
    const double size = weight * normal.norm();
    const double mean = 0.5 * (curvatures->smallest + curvatures->largest);
    const double gaussian = curvatures->smallest * curvatures->largest;
    // The integrals of the area, and of the depth over it, from the surface to the thickness.
    const double volume = size * t * (1.0 - mean * t + gaussian * t * t / 3.0);
    const double depth = size * t * t * (0.5 - 2.0 / 3.0 * mean * t + 0.25 * gaussian * t * t);
    mass.volume_m3 += volume;
    mass.middle_m += volume * (point.position_m - origin) - depth * normal.normalized();
  });
  if (mass.volume_m3 != 0.0) mass.middle_m = origin + mass.middle_m / mass.volume_m3;
  return mass;
}

}  // namespace spoonbill
