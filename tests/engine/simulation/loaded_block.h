// Provides a block of material for tests of loads and supports.
#pragma once

#include <optional>
#include <vector>

#include "engine/material/implicit/implicit_solver.h"
#include "engine/material/lattice_solver.h"
#include "engine/simulation/body_loads.h"

namespace spoonbill {

// Selects the solver: springs, or the implicit solver.
enum class Stepping { springs, implicitly };

inline const BodyRegion block_start{{0.0, 0.0}}, block_end{{1.0, 1.0}};

class LoadedBlock {
 public:
  // Places the block with a corner at the origin. A region's `along` runs along z.
  LoadedBlock(const Vector3& size_m, std::array<int, 3> counts, const Material& material, Stepping stepping);

  void load(const std::vector<Load>& loads);
  void support(const std::vector<Support>& supports);

  void tick(double drag_per_s, const Vector3& gravity_m_per_s2 = Vector3::Zero(),
            GroundContacts* ground = nullptr);

  SpringLattice lattice;
  std::optional<ImplicitSolver> core;
  BodySupports supports;
  BodyLoads loads;
  bool is_critically_damped = false;
  double time_s = 0.0;

  // Returns the mean displacement of the nodes of a slice.
  Vector3 slice_m(int k) const;
  Vector3 support_force_n(int support) const;
  double kinetic_energy_j() const;
};

}  // namespace spoonbill
