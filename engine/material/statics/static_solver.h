// The shape in which a body rests under its loads.
#pragma once

#include "engine/base/progress.h"
#include "engine/material/statics/static_body.h"

namespace spoonbill {

struct StaticSettings {
  // Of the forces that the cells exert on the nodes: what may be left unbalanced.
  double tolerance = 1e-8;
  int step_limit = 400;  // Newton steps in all
  // After each of them; may go back where the loads must grow more slowly. Stops the search, which is then an
  // error.
  Progress progress = {};
};

struct StaticResult {
  std::vector<Vector3> displacement_m;  // one a node
  std::vector<Vector3> reaction_n;      // one a node: what its held axes bear; 0 of the others
  double energy_j = 0.0;                // stored in the cells
  int newton_steps = 0;
};

// Newton's method on the potential energy, by sparse Cholesky factors, with the step halved until the energy
// falls; loads grow in steps where it does not get there at once. Refused: a held axis that is not in the
// body, supports that let the body move freely, loads under which it finds no rest.
Result<StaticResult> rest_under_load(const StaticBody& body, const StaticLoads& loads,
                                     const std::vector<HeldAxis>& held, const StaticSettings& settings = {});

}  // namespace spoonbill
