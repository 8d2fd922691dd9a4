#include "engine/simulation/body_state.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/rigid/rigid_mass.h"

namespace spoonbill {
namespace {

std::string rounded_text(double number) {
  return number_text(std::round(10.0 * number) / 10.0);
}

// Returns a warning if the cells of a body without an implicit solver are too slender; otherwise an empty
// text.
std::string describe_slender_cells(const BodyState& body) {
  if (body.implicit_solver || body.rigid) return {};
  const LatticeReport& report = body.lattice.report();
  int worst = 0;
  const auto error = [&](int axis) { return std::abs(report.youngs_modulus_ratio[axis] - 1.0); };
  for (int axis = 1; axis < 3; ++axis) {
    if (error(axis) > error(worst)) worst = axis;
  }
  if (!(error(worst) > slender_stiffness_limit)) return {};
  return std::string("cells are too slender for sculpting: ") +
         rounded_text(report.youngs_modulus_ratio[worst]) + " times as stiff as the material along " +
         "xyz"[worst] + "; give a node_budget instead of nodes";
}

}  // namespace

Result<std::optional<ImplicitSolver>> make_implicit_solver(const SpringLattice& lattice,
                                                           const std::vector<Vector3>& rest_m,
                                                           InstructionSet set) {
  const LatticeMaterials& materials = lattice.materials();
  const bool for_springs = max_youngs_modulus_pa(materials) < stiff_youngs_modulus_pa &&
                           !lattice.mesh().thin && min_poissons_ratio(materials) >= min_spring_poissons_ratio;
  if (!are_linear_elastic(materials) || for_springs) return std::optional<ImplicitSolver>();
  Result<ImplicitSolver> solver = ImplicitSolver::make(lattice.mesh(), rest_m, materials, set);
  if (!solver.ok()) return solver.error();
  return std::optional<ImplicitSolver>(std::move(solver).value());
}

double find_smallest_contact_radius_m(const BodyState& body) {
  constexpr double spring_cells = 2.0, solver_cells = 5.0;
  if (const ImplicitSolver* const solver = body.solver()) return solver_cells * solver->mesh().mean_edge();
  return spring_cells * static_cast<double>(body.lattice.cell_size_m());
}

std::string describe_lattice_warning(const BodyState& body, const LatticeRequest& request) {
  const std::string slender = describe_slender_cells(body);
  if (body.lattice.mesh().along.empty() || request.cells == LatticeCells::box)
    return slender.empty() ? slender : "lattice: " + slender;
  return "lattice: the body is in a box of cells, because no lattice can follow its shape; nodes are counted "
         "along x, y and z, feature_map is ignored, and parts thinner than a cell are too stiff in bending" +
         (slender.empty() ? slender : "; " + slender);
}

std::vector<std::uint8_t> find_nodes_behind(const SpringLattice& lattice,
                                            const std::vector<FixingPlane>& planes) {
  std::vector<std::uint8_t> behind(static_cast<std::size_t>(lattice.mesh().node_count()), 0);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    for (const FixingPlane& plane : planes) {
      if (plane.normal.dot(lattice.position(n) - plane.point_m) <= 0.0)
        behind[static_cast<std::size_t>(n)] = 1;
    }
  }
  return behind;
}

void BodyState::fix_nodes_behind(const std::vector<FixingPlane>& planes) {
  if (rigid) {
    const std::uint8_t is_fixed = rigid->dynamics() ? 0 : 1;
    return fix(std::vector<std::uint8_t>(lattice.mesh().nodes.size(), is_fixed));
  }
  std::vector<std::uint8_t> nodes = find_nodes_behind(lattice, planes);
  supports.claim_nodes(lattice, nodes);
  fix(std::move(nodes));
}

namespace {

// Edges of a rigid mesh are at most this fraction of its size long, so that enough of its vertices lie where
// another body touches it.
constexpr double longest_edge_fraction = 1.0 / 48.0;
constexpr std::size_t refined_triangle_limit = 2 * body_triangle_limit;

// Returns a mesh with shorter edges. They are longer than they should be where that would take too many
// triangles, as on a bundle of needles.
TriangleMesh refine_for_contact(const TriangleMesh& mesh) {
  const double size_m = box_about(mesh.vertices_m).size();
  for (double fraction = longest_edge_fraction; fraction < 1.0; fraction *= 2.0) {
    Result<TriangleMesh> refined = refine_edges(mesh, fraction * size_m, refined_triangle_limit);
    if (refined.ok()) return std::move(refined).value();
  }
  return mesh;
}

}  // namespace

Result<SkinMapping> make_skin(const Body& body, const SpringLattice& lattice,
                              const std::vector<FixingPlane>& planes, InstructionSet set,
                              double contact_cell_m) {
  if (body.mesh) {
    const TriangleMesh mesh = find_placed_mesh(body);
    return SkinMapping(MeshMapping(refine_for_contact(mesh), mesh.triangles, lattice));
  }
  const bool is_rigid = body.kind != BodyKind::deformable;
  Result<BodyMapping> mapping =
      BodyMapping::make(body.surface, body.surface, lattice, is_rigid ? std::vector<FixingPlane>() : planes,
                        set, contact_cell_m);
  if (!mapping.ok()) return mapping.error();
  return SkinMapping(std::move(mapping).value());
}

namespace {

// Refuses a control net that is too large to be moved in every tick.
Status check_net_size(const Body& body) {
  const ControlNet& net = body.surface.net;
  const Range<int>& range = sculpted_control_point_count_range;
  if (body.mesh || (net.rows <= range.high && net.columns <= range.high)) return {};
  const auto limited = [&](int count) { return std::to_string(std::min(count, range.high)); };
  return Error{ErrorCode::too_many,
               "has " + std::to_string(net.rows) + " x " + std::to_string(net.columns) +
                   " control points, and a body that moves has at most " + std::to_string(range.high) +
                   " in a direction; reduce them with `spoonbill change MODEL rebuild --control " +
                   limited(net.rows) + "x" + limited(net.columns) + " --out OTHER`",
               "control_points_mm"};
}

}  // namespace

Result<BodyState> make_body_state(const Body& body, const std::vector<FixingPlane>& planes,
                                  InstructionSet set, const FeatureMapWatch& watch, bool is_real_time) {
  if (Status status = check_net_size(body); !status.ok()) return status.error();
  Result<std::shared_ptr<const TrimmedArea>> trim = make_trimmed_area(body);
  if (!trim.ok()) return trim.error();
  Result<LatticeMesh> mesh = make_body_lattice(body, watch);
  if (!mesh.ok()) return mesh.error();
  const Result<LatticeMaterials> materials = lattice_materials(mesh.value(), body.material, body.regions);
  if (!materials.ok()) return materials.error();
  Result<SpringLattice> lattice = SpringLattice::make(mesh.value(), materials.value(), set);
  if (!lattice.ok()) return lattice.error();
  const bool is_rigid = body.kind != BodyKind::deformable;
  Result<std::optional<ImplicitSolver>> solver = std::optional<ImplicitSolver>();
  if (!is_rigid) solver = make_implicit_solver(lattice.value(), mesh->nodes, set);
  if (!solver.ok()) return solver.error();
  // Stiff bodies, which the implicit solver steps, do not sink in between their samples.
  const bool is_dense = is_real_time && !is_rigid && !solver.value();
  const double contact_cell_m = is_dense ? static_cast<double>(lattice->cell_size_m()) : infinity;
  Result<SkinMapping> skin = make_skin(body, lattice.value(), planes, set, contact_cell_m);
  if (!skin.ok()) return skin.error();
  const auto* const surface = std::get_if<BodyMapping>(&skin.value());
  Result<BodyLoads> loads =
      BodyLoads::make(body.loads, mesh.value(), [&](double u, double v) { return surface->at(u, v); });
  if (!loads.ok()) return loads.error();
  Result<BodySupports> supports = BodySupports::make(body.supports, mesh.value());
  if (!supports.ok()) return supports.error();
  BodyState state{std::move(lattice).value(),
                  std::move(skin).value(),
                  Smoothing(mesh.value()),
                  {},
                  std::vector<std::uint8_t>(mesh->nodes.size(), 0)};
  state.shell_thickness_m = body.shell_thickness_m.value_or(0.0);
  state.trim = std::move(trim).value();
  state.loads = std::move(loads).value();
  state.supports = std::move(supports).value();
  if (body.kind == BodyKind::fixed) state.rigid.emplace();
  if (body.kind == BodyKind::rigid) {
    const std::optional<RigidMass> mass = compute_rigid_mass(body);
    if (!mass) {
      return Error{ErrorCode::degenerate,
                   "the body has no mass that can be computed; a rigid body must be closed and not flat, or "
                   "have a shell thickness",
                   "kind"};
    }
    state.rigid.emplace(RigidDynamics(*mass, state.lattice.mesh()), body.hand);
  }
  state.fix_nodes_behind(planes);
  state.set_implicit_solver(std::move(solver).value());
  return state;
}

}  // namespace spoonbill
