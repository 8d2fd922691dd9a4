#include "engine/material/lattice/solid_lattice.h"

#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/surface_in_box.h"
#include "engine/material/lattice/tube_lattice.h"

namespace spoonbill {

Result<LatticeMesh> solid_lattice(const Surface& surface, const LatticeRequest& request,
                                  const FeatureMapWatch& watch) {
  if (surface.v.is_periodic()) {
    if (Status closed = check_closed(surface); !closed) return closed.error();
    return surface_in_box(surface, request);
  }
  Result<LatticeMesh> along = tube_lattice(surface, request, watch);
  if (along || !check_closed(surface)) return along;
  Result<LatticeMesh> about = surface_in_box(surface, request);
  return about ? about : along;
}

}  // namespace spoonbill
