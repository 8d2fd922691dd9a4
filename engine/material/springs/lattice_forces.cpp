#include "engine/material/springs/lattice_forces.h"

#include <cmath>

namespace spoonbill {
namespace {

void add_loads(const SpringLattice& lattice, const LatticeView& view) {
  if (!lattice.has_applied_force()) return;
  for (int i = 0; i < view.padded_count; ++i) {
    view.fx[i] += lattice.applied_force(0)[i];
    view.fy[i] += lattice.applied_force(1)[i];
    view.fz[i] += lattice.applied_force(2)[i];
  }
}

void add_weights(const SpringLattice& lattice, const LatticeView& view, const Vector3& gravity_m_per_s2) {
  if (gravity_m_per_s2.isZero(0.0)) return;
  const float g[3] = {static_cast<float>(gravity_m_per_s2.x()), static_cast<float>(gravity_m_per_s2.y()),
                      static_cast<float>(gravity_m_per_s2.z())};
  lattice.kernels().add_weights(view, lattice.masses(), g);
}

// Adds the change of the spring forces since the linearisation, whose tangents may not be stored yet.
void add_change_of_springs(const LatticeKernels& kernels, const LatticeView& view,
                           LinearisedSprings& springs) {
  if (springs.stored == Linearised::forces) kernels.store_tangents(view);
  springs.stored = Linearised::tangents;
  kernels.spring_forces(view);
}

}  // namespace

LinearisedSprings linearise(const SpringLattice& lattice, const LatticeView& view, Linearised stored) {
  lattice.kernels().linearise_springs(view, lattice.damping_time_s(), stored);
  return {stored};
}

LinearisedSprings linearise_and_follow(SpringLattice& lattice, const LatticeView& view, Linearised stored) {
  const float square = lattice.kernels().linearise_with_power_step(view, lattice.damping_time_s(), stored,
                                                                   lattice.free_mass());
  if (square > 0.0f && std::isfinite(square)) lattice.set_fastest_square(static_cast<double>(square));
  return {stored};
}

void compute_forces(const SpringLattice& lattice, const LatticeView& view, float moved_square,
                    const Vector3& gravity_m_per_s2, LinearisedSprings& springs) {
  const LatticeKernels& kernels = lattice.kernels();
  const float limit = static_cast<float>(linear_cells) * lattice.cell_size_m();
  const bool is_linear = moved_square <= limit * limit;
  if (!is_linear) {
    // Nodes that moved so far within one substep will probably do so in the next one. That substep then needs
    // no tangents. A soft tool's frame moves the positions at which they would be computed later.
    const bool is_fast = springs.age_substeps == 1 && !lattice.is_damped_further() && view.frame == nullptr;
    springs = linearise(lattice, view, is_fast ? Linearised::forces : Linearised::tangents);
  }
  ++springs.age_substeps;
  kernels.start_forces(view);
  if (is_linear && moved_square > 0.0f) add_change_of_springs(kernels, view, springs);
  kernels.volume_forces(view);
  if (lattice.is_damped_further()) kernels.damp_further(view);
  add_loads(lattice, view);
  add_weights(lattice, view, gravity_m_per_s2);
}

}  // namespace spoonbill
