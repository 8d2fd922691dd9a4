#include "engine/material/lattice/lattice_of.h"

#include "engine/material/lattice/shell_lattice.h"
#include "engine/material/lattice/solid_lattice.h"

namespace spoonbill {

Result<LatticeMesh> lattice_of(const Body& body, const FeatureMapWatch& watch) {
  if (body.shell_thickness_m) return shell_lattice(body.surface, *body.shell_thickness_m, body.lattice);
  return solid_lattice(body.surface, body.lattice, watch);
}

}  // namespace spoonbill
