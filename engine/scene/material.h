// Materials in SI units, and the parts of a body that have a material or a friction of their own. Plain data.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Properties of a material as the solvers use them. fields_of<Material> defines their names and ranges in
// files, in the panel and in checks.
struct Material {
  std::string name;
  std::string source;
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
  // Voigt damping of changes of shape, not of volume. The viscous stress is the product of the elastic
  // stiffness, the damping time and the strain rate. A vibration of frequency f has the loss factor 2 pi f
  // times the damping time.
  double damping_time_s = 0.0;
  bool plastic = false;
  double yield_strain = 0.0;  // a spring's rest length flows above this deviatoric strain
  // Rate at which a spring's rest length flows, per unit of strain beyond the yield strain and per second of
  // real time.
  double flow_rate_per_s = 0.0;
  double hardening = 0.0;  // growth of the yield strain per unit of permanent strain
  // Coefficient b of the factor by which a spring's stiffness changes with its strain e. For b > 0 the spring
  // stiffens by the factor 1 + b e^2, at most 2. For b < 0 it softens by the factor (1 - b e^2)^(-1/2).
  double stiffening = 0.0;
  // Fraction of the stress that relaxes at constant strain, with the time constant `relaxation_time_s`. 0: no
  // creep.
  double relaxing_fraction = 0.0;
  double relaxation_time_s = 1.0;
  double friction = 0.0;  // Coulomb friction coefficient of the surface
  // Stress at which a material that is not plastic yields or breaks. Reports compare stresses with it; no
  // solver uses it. 0: not known.
  double yield_strength_pa = 0.0;
  std::string yield_source;  // where that stress comes from
};

// Range of Young's modulus, from the softest gel to beyond diamond. If all properties of a material are
// within their ranges, every solver stays finite.
inline constexpr Range<double> youngs_modulus_range_pa{1.0, 1e12};
inline constexpr Range<double> poissons_ratio_range{0.0, 0.49};
// Smallest Poisson's ratio of plastic, creeping and stiffening materials, which are simulated with springs.
// Below it, springs would need a volume force that is unstable under contact.
inline constexpr double min_spring_poissons_ratio = 0.2;
// Range of the density, from aerogel to beyond osmium.
inline constexpr Range<double> density_range_kg_per_m3{1.0, 30000.0};
// Range of the damping time. With a longer damping time, a tick would need more substeps than can be computed
// in time.
inline constexpr Range<double> damping_time_range_s{0.0, 0.005};
inline constexpr Range<double> yield_strain_range{1e-4, 0.5};  // for plastic materials
// Range of the yield strain of materials that are not plastic. Such materials ignore the value.
inline constexpr Range<double> elastic_yield_strain_range{0.0, 0.5};
inline constexpr Range<double> flow_rate_range_per_s{0.0, 8000.0};
// Range of the hardening. Above the upper limit, clay would spring back.
inline constexpr Range<double> hardening_range{0.0, 1.0};
inline constexpr Range<double> stiffening_range{-1000.0, 1000.0};
inline constexpr Range<double> relaxing_fraction_range{0.0, 1.0};
inline constexpr Range<double> relaxation_time_range_s{0.1, 1e6};
inline constexpr Range<double> friction_range{0.0, 5.0};
inline constexpr Range<double> yield_strength_range_pa{0.0, 1e11};

inline constexpr Range<double> yield_strain_range_for(bool plastic) {
  return plastic ? yield_strain_range : elastic_yield_strain_range;
}

template <>
inline constexpr auto fields_of<Material> = std::to_array<Field<Material>>({
    text_field("name", &Material::name),
    text_field("source", &Material::source, "Where the values come from"),
    number_field("youngs_modulus_pa", &Material::youngs_modulus_pa, youngs_modulus_range_pa,
                 FieldUnit::pascal)
        .with_slider({"E", {1e3, 1e12}, true}),
    number_field("poissons_ratio", &Material::poissons_ratio, poissons_ratio_range)
        .with_slider({"Poisson", poissons_ratio_range, false}),
    number_field("density_kg_per_m3", &Material::density_kg_per_m3, density_range_kg_per_m3,
                 FieldUnit::kilogram_per_m3)
        .with_slider({"Density", {50.0, 20000.0}, true}),
    number_field("damping_time_s", &Material::damping_time_s, damping_time_range_s, FieldUnit::second),
    switch_field("plastic", &Material::plastic),
    number_field("yield_strain", &Material::yield_strain, elastic_yield_strain_range, FieldUnit::none,
                 "At least 1e-4 for a plastic material")
        .with_range_by([](const Material& material) { return yield_strain_range_for(material.plastic); }),
    number_field("flow_rate_per_s", &Material::flow_rate_per_s, flow_rate_range_per_s, FieldUnit::per_second),
    number_field("hardening", &Material::hardening, hardening_range).optional(),
    number_field("stiffening", &Material::stiffening, stiffening_range).optional(),
    number_field("friction", &Material::friction, friction_range).optional(),
    number_field("relaxing_share", &Material::relaxing_fraction, relaxing_fraction_range).optional(),
    number_field("relaxation_time_s", &Material::relaxation_time_s, relaxation_time_range_s,
                 FieldUnit::second)
        .with_partner("relaxing_share"),
    number_field("yield_strength_pa", &Material::yield_strength_pa, yield_strength_range_pa,
                 FieldUnit::pascal, "Stress at which a material that is not plastic yields or breaks")
        .optional(),
    text_field("yield_source", &Material::yield_source, "Where the yield strength comes from").optional(),
});

// Returns true if the material does not flow, creep or stiffen. Such a material can be simulated with
// hexahedral elements, at any Poisson's ratio.
bool is_linear_elastic(const Material& material);

// Returns the stress at which a material yields or breaks; 0 if it is not known.
double find_yield_stress_pa(const Material& material);

// Refuses a material with a value outside its range, and a material that both flows and creeps. Refuses a
// Poisson's ratio below min_spring_poissons_ratio unless the material is linear elastic. The error names the
// field.
Status check_material(const Material& material);

// Position of a point in the body's own coordinates. All values are NaN for lattice nodes outside the body.
struct BodyCoordinates {
  double along = 0.0;   // fraction of the body's length, or of a ring's circumference; 0 to 1
  double around = 0.0;  // fraction of a turn, 0 to 1; set to 0 on the axis
  double depth_m = 0.0;
};

// Part of a body in the body's own coordinates, which deformation does not change. The default is the whole
// body.
struct BodyRegion {
  Range<double> along{0.0, 1.0};   // fraction of the body's length, or of a ring's circumference, along v
  Range<double> around{0.0, 1.0};  // fraction of a turn along u; the range crosses the seam if low > high
  Range<double> depth_m{0.0, std::numeric_limits<double>::infinity()};  // depth below the surface at rest
};

bool contains(const BodyRegion& region, const BodyCoordinates& point);

// Returns an error that names the first invalid field. All fractions must be from 0 to 1, and depths must be
// at least 0. The lower ends of `along` and `depth_m` must not be above the upper ends. The ends of `around`
// must differ.
Status check_region(const BodyRegion& region);

// Region of a body whose material or friction differs from the rest of the body.
struct MaterialRegion {
  BodyRegion region;
  // Material of the region; if empty, the region keeps the material that it has without this entry.
  std::optional<Material> material = {};
  // Friction coefficient of the region. If it is empty, the friction of `material` applies.
  std::optional<double> friction = {};
};

inline constexpr Range<int> material_region_count_range{0, 16};

// Refuses an invalid region, a material or friction out of range, and an entry that has neither material nor
// friction. The error names the field.
Status check_material_region(const MaterialRegion& region);

}  // namespace spoonbill
