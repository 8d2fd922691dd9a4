// A block of material that loads and supports act on, for their tests.
#pragma once

#include <optional>
#include <vector>

#include "engine/material/implicit/implicit_core.h"
#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_loads.h"
#include "engine/simulation/body_supports.h"

namespace spoonbill {

// Stepped by its springs, or by the implicit block inside it.
enum class Stepping { springs, implicitly };

class LoadedBlock {
 public:
  // Its corner at the origin; `along` a region counts along z. It is damped, so that it settles.
  LoadedBlock(const Vector3& size_m, std::array<int, 3> counts, const Material& material, Stepping stepping);

  void load(const std::vector<Load>& loads);
  void support(const std::vector<Support>& supports);

  void tick(double damping_per_s, const Vector3& gravity_m_per_s2 = Vector3::Zero(),
            GroundContacts* ground = nullptr);

  SpringLattice lattice;
  std::optional<ImplicitCore> core;
  BodySupports supports;
  BodyLoads loads;
  double load_share = 1.0;
  bool settles = false;
  double time_s = 0.0;

  // The mean displacement of the nodes of a slice.
  Vector3 slice_m(int k) const;
  Vector3 support_force_n(int support) const;
  double kinetic_energy_j() const;
};

}  // namespace spoonbill
