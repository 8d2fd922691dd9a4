#include "engine/simulation/soft_mesh.h"

#include <utility>

#include "engine/collision/meshes/mesh_parts.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/material/lattice/box_lattice.h"
#include "engine/material/lattice/lattice_counts.h"

namespace spoonbill {
namespace {

double volume_of(const CleanMesh& mesh) {
  double volume = 0.0;
  for (const MeshPart& part : mesh.parts) volume += signed_volume(mesh.mesh, part);
  return volume;
}

double shortest_cell_edge(const Vector3& size, const std::array<int, 3>& counts) {
  return size.cwiseQuotient(Vector3(counts[0] - 1, counts[1] - 1, counts[2] - 1)).minCoeff();
}

}  // namespace

Result<BodyState> make_soft_mesh(const MeshSolid& solid, const SoftTool& soft, InstructionSet set) {
  const TriangleMesh& mesh = solid.mesh.mesh;
  const ShellDistance inside(mesh.vertices_m, mesh.triangles, ShellDistance::Kind::solid);
  if (!inside.uses_normals()) {
    return Error{
        "mesh: passes through itself or has edges of more than two triangles; mend it, or leave soft out"};
  }
  const Vector3 size = inside.bounds().high - inside.bounds().low;
  const Result<std::array<int, 3>> counts = lattice_counts(soft.lattice, size);
  if (!counts.ok()) return counts.error();
  Result<TriangleMesh> skin = refine_edges(mesh, soft_edge_cells * shortest_cell_edge(size, counts.value()),
                                           soft_mesh_triangle_limit);
  if (!skin.ok()) {
    return Error{"mesh: " + skin.error().message + ", half a lattice cell; use fewer lattice nodes"};
  }
  Result<LatticeMesh> box = box_lattice(inside, volume_of(solid.mesh), skin->vertices_m, counts.value());
  if (!box.ok()) return box.error();
  Result<SpringLattice> lattice = sculpting_lattice(box.value(), soft.material, set);
  if (!lattice.ok()) return lattice.error();
  MeshMapping mapping(skin.value(), lattice.value());
  const std::vector<std::uint8_t> none(static_cast<std::size_t>(box->node_count()), 0);
  return BodyState{std::move(lattice).value(), std::move(mapping), Smoothing(box.value()), none, none};
}

}  // namespace spoonbill
