#include "engine/inspection/mass_properties.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <set>

#include "engine/base/assert.h"
#include "engine/bspline/quadrature.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/inspection/curvature.h"
#include "engine/inspection/surface_check.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice_materials.h"
#include "engine/material/rigid/rigid_mass.h"

namespace spoonbill {
EnclosedMass compute_enclosed_mass(const Surface& surface, const TrimmedArea& area) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  // Moments are taken about a control point, so that a large distance from the origin costs no precision.
  const Vector3 origin = surface.net.point(0, 0);
  EnclosedMass mass;
  // Along a direction of degree p, the integrand of the first moment has degree 4 p - 1.
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const Vector3 offset = point.position_m - origin;
    const Vector3 normal = weight * point.du.cross(point.dv);
    const double size = normal.norm(), cone = offset.dot(normal) / 3.0;
    mass.area_m2 += size;
    mass.area_centre_m += size * offset;
    mass.volume_m3 += cone;
    mass.centre_m += 0.75 * cone * offset;  // a cone's centroid is at 3/4 of its height from the tip
  });
  if (mass.area_m2 > 0.0) mass.area_centre_m = origin + mass.area_centre_m / mass.area_m2;
  if (mass.volume_m3 != 0.0) mass.centre_m = origin + mass.centre_m / mass.volume_m3;
  return mass;
}

ShellMass compute_shell_mass(const Surface& surface, double thickness_m, const TrimmedArea& area) {
  SPOONBILL_ASSERT(thickness_m > 0.0);
  const Vector3 origin = surface.net.point(0, 0);
  const double t = thickness_m;
  ShellMass mass;
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const auto curvatures = compute_principal_curvatures(point);
    if (!curvatures) return;
    const Vector3 normal = point.du.cross(point.dv);
    const double size = weight * normal.norm();
    const double mean = 0.5 * (curvatures->smallest + curvatures->largest);
    const double gaussian = curvatures->smallest * curvatures->largest;
    // Volume of the shell, which is the area of parallel surfaces integrated over the thickness; then the
    // same integral weighted by the depth.
    const double volume = size * t * (1.0 - mean * t + gaussian * t * t / 3.0);
    const double depth = size * t * t * (0.5 - 2.0 / 3.0 * mean * t + 0.25 * gaussian * t * t);
    mass.volume_m3 += volume;
    mass.centre_m += volume * (point.position_m - origin) - depth * normal.normalized();
  });
  if (mass.volume_m3 != 0.0) mass.centre_m = origin + mass.centre_m / mass.volume_m3;
  return mass;
}

namespace {

struct Sums {
  double volume_m3 = 0.0, mass_kg = 0.0;
  Vector3 volume_moment = Vector3::Zero(), mass_moment = Vector3::Zero();
};

Vector3 find_centroid(const CellCorners& corners) {
  return std::accumulate(corners.begin(), corners.end(), Vector3(Vector3::Zero())) / 8.0;
}

}  // namespace

Result<MaterialMix> compute_material_mix(const Body& body) {
  const auto mesh = make_body_lattice(body);
  if (!mesh) return mesh.error();
  const auto materials = lattice_materials(mesh.value(), body.material, body.regions);
  if (!materials) return materials.error();
  Sums sums;
  double own_volume_m3 = 0.0;
  std::set<std::size_t> found;
  for (int k = 0; k + 1 < mesh->count[2]; ++k) {
    for (int i = 0; i + 1 < mesh->count[0]; ++i) {
      for (int j = 0; j + 1 < mesh->count[1]; ++j) {
        const CellCorners corners = mesh->cell(i, j, k);
        const double volume = mesh->cell_fraction(i, j, k) * cell_volume(corners);
        if (!(volume > 0.0)) continue;
        const std::size_t material = materials->index_of(mesh->cell_index(i, j, k));
        const double mass = volume * materials->materials[material].density_kg_per_m3;
        found.insert(material);
        sums.volume_m3 += volume;
        if (material == 0) own_volume_m3 += volume;
        sums.mass_kg += mass;
        sums.volume_moment += volume * find_centroid(corners);
        sums.mass_moment += mass * find_centroid(corners);
      }
    }
  }
  if (!(sums.volume_m3 > 0.0)) return Error{ErrorCode::degenerate, "the lattice of the body has no volume"};
  MaterialMix mix;
  mix.own_fraction = own_volume_m3 / sums.volume_m3;
  mix.own_density_kg_per_m3 = body.material.density_kg_per_m3;
  mix.density_kg_per_m3 = sums.mass_kg / sums.volume_m3;
  mix.mass_offset_m = sums.mass_moment / sums.mass_kg - sums.volume_moment / sums.volume_m3;
  for (const std::size_t material : found) mix.materials.push_back(materials->materials[material].name);
  return mix;
}

BodyMass mass_of_volume(const Body& body, double volume_m3, const Vector3& centre_m) {
  BodyMass mass;
  mass.volume_m3 = volume_m3;
  mass.mix.density_kg_per_m3 = mass.mix.own_density_kg_per_m3 = body.material.density_kg_per_m3;
  mass.mix.materials = {body.material.name};
  const bool is_mixed = std::any_of(body.regions.begin(), body.regions.end(),
                                    [](const MaterialRegion& region) { return region.material.has_value(); });
  if (is_mixed) {
    auto mix = compute_material_mix(body);
    if (mix) mass.mix = std::move(mix).value();
    if (!mix) mass.note = "regions ignored: " + mix.error().message;
  }
  mass.centre_m = centre_m + mass.mix.mass_offset_m;
  return mass;
}

std::optional<BodyMass> compute_body_mass(const Body& body) {
  if (body.mesh) {
    const std::optional<RigidMass> mass = compute_rigid_mass(body);
    if (!mass) return std::nullopt;
    return mass_of_volume(body, mass->mass_kg / body.material.density_kg_per_m3, mass->centre_m);
  }
  const auto trim = make_trimmed_area(body);
  if (!trim) return std::nullopt;
  const TrimmedArea area = trim.value() ? *trim.value() : TrimmedArea();
  if (body.shell_thickness_m) {
    const ShellMass shell = compute_shell_mass(body.surface, *body.shell_thickness_m, area);
    return mass_of_volume(body, shell.volume_m3, shell.centre_m);
  }
  if (!area.is_whole() || find_closing(body.surface).closedness != Closedness::solid) return std::nullopt;
  const EnclosedMass mass = compute_enclosed_mass(body.surface);
  return mass_of_volume(body, std::abs(mass.volume_m3), mass.centre_m);
}

}  // namespace spoonbill
