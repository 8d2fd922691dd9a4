// A material as the designer names it. Plain data; SI units.
#pragma once

#include <array>
#include <string>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Here is what the numbers mean to the solvers; files, the panel and the checks go by the table below.
struct Material {
  std::string name;
  std::string source;
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
  // Voigt damping along each spring: the ratio z of the lattice's fastest mode.
  double damping_ratio = 0.0;
  bool plastic = false;
  double yield_strain = 0.0;     // deviatoric strain of a spring from which its rest length flows
  double flow_rate_per_s = 0.0;  // of the rest length, by the strain beyond yield
  double hardening = 0.0;        // by how much the yield strain grows with the strain that stays
  // Above 0, springs stiffen with their strain e as 1 + b e^2, up to twice; below 0, they soften as
  // (1 - b e^2)^(-1/2).
  double stiffening = 0.0;
  // Of a material that creeps: at a constant strain this share of the stress goes, with this time constant.
  double relaxing_share = 0.0;
  double relaxation_time_s = 1.0;
  double friction = 0.0;  // Coulomb's coefficient of its surface
};

// From the softest gel to beyond diamond, from an aerogel to beyond osmium: every solver stays finite inside.
inline constexpr Range<double> youngs_modulus_range_pa{1.0, 1e12};
inline constexpr Range<double> poissons_ratio_range{0.0, 0.49};
// Of what flows, creeps or stiffens, which springs do. Below, a volume force that makes springs so is
// unstable under contact.
inline constexpr double least_spring_poissons_ratio = 0.2;
inline constexpr Range<double> density_range_kg_per_m3{1.0, 30000.0};
inline constexpr Range<double> damping_ratio_range{0.0, 2.0};
inline constexpr Range<double> yield_strain_range{1e-4, 0.5};         // of plastic materials
inline constexpr Range<double> elastic_yield_strain_range{0.0, 0.5};  // kept but unused where nothing flows
inline constexpr Range<double> flow_rate_range_per_s{0.0, 1000.0};
// Harder, clay springs back.
inline constexpr Range<double> hardening_range{0.0, 1.0};
inline constexpr Range<double> stiffening_range{-1000.0, 1000.0};
inline constexpr Range<double> relaxing_share_range{0.0, 1.0};
inline constexpr Range<double> relaxation_time_range_s{0.1, 1e6};
inline constexpr Range<double> friction_range{0.0, 5.0};

inline constexpr Range<double> yield_strain_range_of(bool plastic) {
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
    // Of a Voigt element a mode's loss factor is twice its damping ratio.
    number_field("damping_ratio", &Material::damping_ratio, damping_ratio_range)
        .with_alias({"loss_factor", 2.0, "Twice the damping ratio"}),
    switch_field("plastic", &Material::plastic),
    number_field("yield_strain", &Material::yield_strain, elastic_yield_strain_range, FieldUnit::none,
                 "Of a plastic material at least 1e-4")
        .with_range_by([](const Material& material) { return yield_strain_range_of(material.plastic); }),
    number_field("flow_rate_per_s", &Material::flow_rate_per_s, flow_rate_range_per_s, FieldUnit::per_second),
    number_field("hardening", &Material::hardening, hardening_range).optional(),
    number_field("stiffening", &Material::stiffening, stiffening_range).optional(),
    number_field("friction", &Material::friction, friction_range).optional(),
    number_field("relaxing_share", &Material::relaxing_share, relaxing_share_range).optional(),
    number_field("relaxation_time_s", &Material::relaxation_time_s, relaxation_time_range_s,
                 FieldUnit::second)
        .with_partner("relaxing_share"),
});

// Whether it is elastic and nothing else, as hexahedra are: those serve any Poisson's ratio.
bool is_plainly_elastic(const Material& material);

// The ranges within which every solver stays finite; the message names the field, the value and the range.
Status check_material(const Material& material);

}  // namespace spoonbill
