#include "engine/simulation/body_state.h"

#include <algorithm>

#include "engine/material/lattice/tube_lattice.h"
#include "engine/material/lattice_solver.h"

namespace spoonbill {

Result<SpringLattice> sculpting_lattice(const LatticeMesh& mesh, const Material& material,
                                        InstructionSet set) {
  // Measured at 1 Pa: frequencies scale with the root of the modulus, the springs with the modulus.
  Result<SpringLattice> unit = SpringLattice::make(mesh, material, 1.0, set);
  if (!unit.ok()) return unit;
  const double unit_limit = felt_modulus_limit_pa(unit->fastest_frequency(), material.damping_ratio);
  return SpringLattice::make(mesh, material, std::min(material.youngs_modulus_pa, unit_limit), set);
}

Result<std::optional<ImplicitCore>> core_of(const SpringLattice& lattice, const std::vector<Vector3>& rest_m,
                                            InstructionSet set) {
  const Material& material = lattice.material();
  const bool for_springs = material.youngs_modulus_pa < stiff_youngs_modulus_pa &&
                           material.poissons_ratio >= least_spring_poissons_ratio;
  if (!is_plainly_elastic(material) || for_springs) return std::optional<ImplicitCore>();
  Result<ImplicitCore> core = ImplicitCore::make(lattice.mesh(), rest_m, material, set);
  if (!core.ok()) return core.error();
  return std::optional<ImplicitCore>(std::move(core).value());
}

std::vector<std::uint8_t> nodes_behind(const SpringLattice& lattice, const std::vector<FixingPlane>& planes) {
  std::vector<std::uint8_t> held(static_cast<std::size_t>(lattice.mesh().node_count()), 0);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    for (const FixingPlane& plane : planes) {
      if (plane.normal.dot(lattice.position(n) - plane.point_m) <= 0.0) held[static_cast<std::size_t>(n)] = 1;
    }
  }
  return held;
}

void BodyState::hold_behind(const std::vector<FixingPlane>& planes) {
  std::vector<std::uint8_t> nodes = nodes_behind(lattice, planes);
  supports.take_nodes(lattice, nodes);
  hold(std::move(nodes));
}

Result<BodyState> make_body_state(const Body& body, const std::vector<FixingPlane>& planes,
                                  InstructionSet set) {
  Result<LatticeMesh> mesh = tube_lattice(body.surface, body.lattice);
  if (!mesh.ok()) return mesh.error();
  Result<SpringLattice> lattice = sculpting_lattice(mesh.value(), body.material, set);
  if (!lattice.ok()) return lattice.error();
  Result<std::optional<ImplicitCore>> core = core_of(lattice.value(), mesh->nodes, set);
  if (!core.ok()) return core.error();
  Result<BodyMapping> mapping = BodyMapping::make(body.surface, body.surface, lattice.value(), planes, set);
  if (!mapping.ok()) return mapping.error();
  Result<BodyLoads> loads =
      BodyLoads::make(body.loads, mesh.value(), [&](double u, double v) { return mapping->at(u, v); });
  if (!loads.ok()) return loads.error();
  Result<BodySupports> supports = BodySupports::make(body.supports, mesh.value());
  if (!supports.ok()) return supports.error();
  BodyState state{std::move(lattice).value(),
                  std::move(mapping).value(),
                  Smoothing(mesh.value()),
                  {},
                  std::vector<std::uint8_t>(mesh->nodes.size(), 0)};
  state.loads = std::move(loads).value();
  state.supports = std::move(supports).value();
  state.hold_behind(planes);
  state.set_core(std::move(core).value());
  return state;
}

}  // namespace spoonbill
