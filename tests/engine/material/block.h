// Provides blocks of material for tests of the lattice.
#pragma once

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Returns an elastic, undamped material.
Material elastic_material(double youngs_modulus_pa, double poissons_ratio, double density_kg_per_m3);

// Returns the lattice of a box of the material with one corner at the origin.
SpringLattice block(const Vector3& size_m, std::array<int, 3> counts, const Material& material,
                    InstructionSet set = InstructionSet::baseline);

// Linearises the springs at the shape that is expected `tau_s` later, and computes the forces of that shape.
void take_forces(SpringLattice& lattice, float tau_s);

// Makes one substep without any tool: forces, kick, drift.
void plain_substep(SpringLattice& lattice, float h_s);

struct Momentum {
  Vector3 sum = Vector3::Zero();
  double size = 0.0;  // sum of the magnitudes m |v| of the nodes' momenta
  double energy_j = 0.0;
};
Momentum momentum_of(const SpringLattice& lattice);

}  // namespace spoonbill
