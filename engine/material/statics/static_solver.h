// Equilibrium shape of a body under its loads.
#pragma once

#include "engine/base/progress.h"
#include "engine/material/statics/static_body.h"

namespace spoonbill {

struct StaticSettings {
  // Largest accepted unbalanced force, relative to the forces of the cells or the loads, whichever are
  // larger.
  double tolerance = 1e-8;
  int step_limit = 400;  // largest number of Newton steps in total
  // Largest number of multiplications for one factor of the stiffness matrix. A body that needs more is
  // refused beforehand. At the default, a factor takes a few seconds, and a body needs about five factors.
  double work_limit = 1e10;
  // Progress, reported several times a second, also within a factorisation. It may decrease when the loads
  // must be applied in smaller steps. Cancelling it makes rest_under_load() fail.
  Progress progress = {};
};

struct StaticResult {
  std::vector<Vector3> displacement_m;  // displacement of each node
  std::vector<Vector3> reaction_n;      // reaction at the fixed axes of each node; 0 for free nodes
  double energy_j = 0.0;                // energy stored in the cells
  int newton_steps = 0;
  bool is_fixed_everywhere = false;  // true if no node is free to move
};

// Minimises the potential energy by Newton's method with sparse Cholesky factors, halving each step until the
// energy falls. If the method does not converge for the full loads, they are applied in steps. Fails on a
// fixed axis outside the body, supports that leave the body free to move, a body too large for the work
// limit, and loads without an equilibrium. A body that is fixed everywhere gets the displacements of its
// fixed axes.
Result<StaticResult> rest_under_load(const StaticBody& body, const StaticLoads& loads,
                                     const std::vector<FixedAxis>& fixed,
                                     const StaticSettings& settings = {});

}  // namespace spoonbill
