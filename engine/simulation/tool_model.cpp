#include "engine/simulation/tool_model.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/meshes/mesh_edges.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/material/lattice/box_lattice.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {
namespace {

double compute_volume(const CleanMesh& mesh) {
  double volume = 0.0;
  for (const MeshPart& part : mesh.parts) volume += signed_volume(mesh.mesh, part);
  return volume;
}

double find_shortest_cell_edge(const Vector3& size, const std::array<int, 3>& counts) {
  return size.cwiseQuotient(Vector3(counts[0] - 1, counts[1] - 1, counts[2] - 1)).minCoeff();
}

}  // namespace

Result<BodyState> make_soft_mesh(const MeshSolid& solid, const SoftTool& soft, InstructionSet set) {
  const TriangleMesh& mesh = solid.mesh.mesh;
  const ShellDistance inside(mesh.vertices_m, mesh.triangles, ShellDistance::Kind::solid);
  if (!inside.uses_normals()) {
    return Error{
        ErrorCode::self_intersecting,
        "mesh: passes through itself or has edges of more than two triangles; repair it or omit soft",
        "mesh"};
  }
  const Vector3 size = inside.bounds().high - inside.bounds().low;
  const Result<std::array<int, 3>> counts = lattice_counts(soft.lattice, size);
  if (!counts.ok()) return counts.error();
  Result<TriangleMesh> skin = refine_edges(
      mesh, soft_edge_cells * find_shortest_cell_edge(size, counts.value()), soft_mesh_triangle_limit);
  if (!skin.ok()) {
    return Error{skin.error().code,
                 "mesh: " + skin.error().message + ", half a lattice cell; use fewer lattice nodes", "mesh"};
  }
  Result<LatticeMesh> box = box_lattice(inside, compute_volume(solid.mesh), skin->vertices_m, counts.value());
  if (!box.ok()) return box.error();
  Result<SpringLattice> lattice = SpringLattice::make(box.value(), soft.material, set);
  if (!lattice.ok()) return lattice.error();
  MeshMapping mapping(skin.value(), lattice.value());
  const std::vector<std::uint8_t> none(static_cast<std::size_t>(box->node_count()), 0);
  return BodyState{std::move(lattice).value(), std::move(mapping), Smoothing(box.value()), none, none};
}

namespace {

// Number of times that the elements of a rigid tool are halved: samples are a quarter of an element apart.
constexpr int tool_levels = 2;

// Returns the distance of the farthest corner of the box from the origin, at most 0.1 m, because some tools,
// such as a half-space, are unbounded.
double measure_extent(const Box& box) {
  constexpr double limit_m = 0.1;
  return std::min(box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).norm(), limit_m);
}

struct ModelBuilder {
  const ToolBody& body;
  InstructionSet set;

  Result<ToolModel> operator()(const ImplicitShape& shape) const {
    ToolModel model;
    model.distance = make_signed_distance(shape);
    model.extent_m = measure_extent(model.distance->bounds());
    return model;
  }

  Result<ToolModel> operator()(const MeshSolid& solid) const {
    if (body.soft) return make_soft_model(make_soft_mesh(solid, *body.soft, set));
    ToolModel model;
    model.distance = std::make_shared<MeshDistance>(solid.mesh);
    model.extent_m = measure_extent(model.distance->bounds());
    return model;
  }

  Result<ToolModel> operator()(const SurfaceSolid& solid) const {
    ToolModel model;
    if (body.soft) {
      return make_soft_model(
          make_body_state({"tool", solid.surface, body.soft->material, body.soft->lattice}, {}, set));
    }
    Result<NestedGrid> nested = make_nested_grid(solid.surface.u, solid.surface.v, tool_levels);
    if (!nested.ok()) return nested.error();
    model.nested = std::make_shared<NestedGrid>(std::move(nested).value());
    model.surface = std::make_shared<Surface>(solid.surface);
    const ControlNet& net = solid.surface.net;
    for (int i = 0; i < net.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) {
        model.extent_m = std::max(model.extent_m, net.point(i, j).norm());
      }
    }
    return model;
  }

  // Makes the model of a soft tool. The hand holds the nodes behind its grip plane.
  Result<ToolModel> make_soft_model(Result<BodyState> soft) const {
    if (!soft.ok()) return soft.error().in("tool");
    // A soft tool uses the spring solver, not an implicit solver, because the hand moves single nodes of the
    // lattice.
    soft->set_implicit_solver(std::nullopt);
    soft->fixed = find_nodes_behind(soft->lattice, {body.soft->grip});
    ToolModel model;
    const LatticeMesh& mesh = soft->lattice.mesh();
    bool holds_any = false;
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (soft->fixed[static_cast<std::size_t>(n)] == 0) continue;
      const auto [i, j, k] = mesh.grid_index(n);
      holds_any |= mesh.node_location(i, j, k) != NodeLocation::outside_body;
      model.gripped.push_back(n);
    }
    if (!holds_any) {
      return Error{ErrorCode::too_few,
                   "tool: no lattice node of the tool is behind the grip plane; move the plane", "grip"};
    }
    if (soft->mesh()) model.triangles = soft->mesh()->triangles();
    soft->lattice.fix_nodes(soft->fixed);
    model.soft = std::move(soft).value();
    return model;
  }
};

}  // namespace

Result<ToolModel> make_tool_model(const Tool& tool, InstructionSet set) {
  SPOONBILL_ASSERT(tool.kind != ToolKind::solid || tool.body != nullptr);
  if (tool.kind != ToolKind::solid) return ToolModel{};
  return std::visit(ModelBuilder{*tool.body, set}, tool.body->solid);
}

}  // namespace spoonbill
