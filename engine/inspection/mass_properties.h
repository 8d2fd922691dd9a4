// Area, volume, centre and density of a surface or a body, by quadrature. The functions are pure, may run on
// any thread, and are too slow for a tick.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Area of a surface and its centre. For a closed surface without trims, also the enclosed volume and its
// centre, by the divergence theorem.
struct EnclosedMass {
  double area_m2 = 0.0;
  Vector3 area_centre_m = Vector3::Zero();
  // Positive if the normals point outwards. Exact up to rounding, because the integrand is a polynomial.
  double volume_m3 = 0.0;
  Vector3 centre_m = Vector3::Zero();  // centre of the volume
};

EnclosedMass compute_enclosed_mass(const Surface& surface, const TrimmedArea& area = {});

// Volume of a shell. The shell is between the part of a surface within its trims and the offset of that part
// in the direction opposite to the normals.
struct ShellMass {
  double volume_m3 = 0.0;
  Vector3 centre_m = Vector3::Zero();  // centre of the volume
};

// Integrates the area of parallel surfaces over the thickness. At depth s that area is dA (1 - 2 H s + K s^2)
// with the mean curvature H and the Gaussian curvature K (Steiner 1840). Valid while the thickness is above 0
// and less than every convex radius of curvature.
ShellMass compute_shell_mass(const Surface& surface, double thickness_m, const TrimmedArea& area = {});

// Densities and centre of mass of a body made of several materials.
struct MaterialMix {
  double density_kg_per_m3 = 0.0;           // mean density of the body
  double own_density_kg_per_m3 = 0.0;       // density of the body's own material
  double own_fraction = 1.0;                // fraction of the volume that the body's own material fills
  Vector3 mass_offset_m = Vector3::Zero();  // from the centre of the volume to the centre of mass
  // Names of the materials in use. The body's own material is first if it is in use.
  std::vector<std::string> materials;
};

// Adds up the cells of the body's lattice, each with the material of its region. Fails for a body for which
// no lattice can be made, and for regions that lattice_materials() refuses.
Result<MaterialMix> compute_material_mix(const Body& body);

// Mass of a body: the exact volume times the mean density. The program states this mass everywhere. The mass
// of the body's lattice, on which forces act, equals it up to rounding, except where trims cut the surface.
struct BodyMass {
  double volume_m3 = 0.0;
  Vector3 centre_m = Vector3::Zero();  // centre of mass
  MaterialMix mix;
  std::string note;  // reason why the material regions are ignored; empty if they are used

  double mass_kg() const { return volume_m3 * mix.density_kg_per_m3; }
  // Returns the mass that the body would have with another density of its own material.
  double mass_kg(double own_density_kg_per_m3) const {
    return mass_kg() + volume_m3 * mix.own_fraction * (own_density_kg_per_m3 - mix.own_density_kg_per_m3);
  }
};

// Returns the mass of a body whose volume and centre have been computed from its surface.
BodyMass mass_of_volume(const Body& body, double volume_m3, const Vector3& centre_m);

// Returns the mass of a body. Returns nothing if the body neither encloses a volume nor is a shell with a
// thickness, or if its trims are invalid.
std::optional<BodyMass> compute_body_mass(const Body& body);

}  // namespace spoonbill
