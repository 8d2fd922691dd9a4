// A material as the designer names it. Plain data; SI units.
#pragma once

#include <string>

#include "engine/base/range.h"
#include "engine/base/result.h"

namespace spoonbill {

struct Material {
  std::string name;    // "modelling-clay"
  std::string source;  // where the values come from
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

// Whether it is elastic and nothing else, as hexahedra are: those serve any Poisson's ratio.
bool is_plainly_elastic(const Material& material);

// The ranges within which every solver stays finite; the message names the field, the value and the range.
Status check_material(const Material& material);

}  // namespace spoonbill
