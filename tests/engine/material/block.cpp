#include "tests/engine/material/block.h"

#include <gtest/gtest.h>

namespace spoonbill {

Material elastic_material(double youngs_modulus_pa, double poissons_ratio, double density_kg_per_m3) {
  Material material;
  material.name = "test";
  material.source = "test";
  material.youngs_modulus_pa = youngs_modulus_pa;
  material.poissons_ratio = poissons_ratio;
  material.density_kg_per_m3 = density_kg_per_m3;
  material.yield_strain = 0.01;
  return material;
}

SpringLattice block(const Vector3& size_m, std::array<int, 3> counts, const Material& material,
                    InstructionSet set) {
  Result<SpringLattice> lattice = SpringLattice::make(box_mesh(size_m, counts), material, set);
  EXPECT_TRUE(lattice.ok()) << lattice.error().message;
  return std::move(lattice).value();
}

void take_forces(SpringLattice& lattice, float tau_s) {
  const LatticeView view = lattice.view();
  const LatticeKernels& kernels = lattice.kernels();
  kernels.linearise_springs(view, tau_s, Linearised::tangents);
  kernels.start_forces(view);
  kernels.volume_forces(view);
}

void plain_substep(SpringLattice& lattice, float h_s) {
  const LatticeView view = lattice.view();
  const LatticeKernels& kernels = lattice.kernels();
  take_forces(lattice, lattice.damping_time_s());
  kernels.kick(view, h_s, 1.0f);
  Drift drift;
  drift.h_s = h_s;
  drift.speeds.cap_m_per_s = 1e6f;
  kernels.drift(view, drift);
}

Momentum momentum_of(const SpringLattice& lattice) {
  Momentum momentum;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const Vector3 own = static_cast<double>(lattice.mass(n)) * lattice.velocity(n);
    momentum.sum += own;
    momentum.size += own.norm();
    momentum.energy_j += 0.5 * own.dot(lattice.velocity(n));
  }
  return momentum;
}

}  // namespace spoonbill
