#include "tests/engine/simulation/loaded_block.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/processor.h"
#include "engine/simulation/simulation.h"
#include "tests/engine/material/block.h"

namespace spoonbill {

LoadedBlock::LoadedBlock(const Vector3& size_m, std::array<int, 3> counts, const Material& material,
                         Stepping stepping)
    : lattice(block(size_m, counts, material)) {
  if (stepping == Stepping::springs) return;
  core =
      ImplicitSolver::make(lattice.mesh(), lattice.mesh().nodes, material, InstructionSet::baseline).value();
  lattice.set_contact_inverse_mass(core->contact_inverse_mass());
}

void LoadedBlock::load(const std::vector<Load>& list) {
  const auto no_surface = [](double, double) { return EmbeddedPoint(); };
  Result<BodyLoads> made = BodyLoads::make(list, lattice.mesh(), no_surface);
  ASSERT_TRUE(made.ok()) << made.error().message;
  loads = std::move(made).value();
}

void LoadedBlock::support(const std::vector<Support>& list) {
  Result<BodySupports> made = BodySupports::make(list, lattice.mesh());
  ASSERT_TRUE(made.ok()) << made.error().message;
  supports = std::move(made).value();
  std::vector<std::uint8_t> held(lattice.mesh().nodes.size(), 0);
  supports.claim_nodes(lattice, held);
  lattice.fix_nodes(held);
  if (core) core->fix_nodes(held);
}

void LoadedBlock::tick(double drag_per_s, const Vector3& gravity_m_per_s2, GroundContacts* ground) {
  const DenormalsFlushed flushed;
  ImplicitSolver* const solver = core ? &*core : nullptr;
  loads.apply(lattice, solver);
  time_s += tick_s;
  supports.clear_impulses();
  const RelaxedLattice relaxed{&lattice, gravity_m_per_s2, solver,
                               supports.begin_step(lattice, time_s, tick_s)};
  RelaxSettings settings;
  settings.tick = static_cast<std::uint64_t>(std::lround(time_s / tick_s));
  settings.drag_per_s = drag_per_s;
  settings.is_critically_damped = is_critically_damped;
  relax(std::array{relaxed}, settings, {}, nullptr, ground);
}

Vector3 LoadedBlock::slice_m(int k) const {
  const LatticeMesh& mesh = lattice.mesh();
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) sum += lattice.displacement(mesh.index(i, j, k));
  }
  return sum / (mesh.count[0] * mesh.count[1]);
}

Vector3 LoadedBlock::support_force_n(int support) const {
  return supports.supports()[static_cast<std::size_t>(support)].impulse_ns / tick_s;
}

double LoadedBlock::kinetic_energy_j() const {
  double sum = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    sum += 0.5 * static_cast<double>(lattice.mass(n)) * lattice.velocity(n).squaredNorm();
  }
  return sum;
}

}  // namespace spoonbill
