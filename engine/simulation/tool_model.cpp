#include "engine/simulation/tool_model.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/simulation/soft_mesh.h"

namespace spoonbill {
namespace {

// Samples of a rigid tool, a quarter of an element apart.
constexpr int levels = 2;

// Of a half-space, which is everywhere, a hand's breadth counts.
double extent_of(const Box& box) {
  constexpr double most = 0.1;
  return std::min(box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).norm(), most);
}

struct ModelOf {
  const ToolBody& body;
  InstructionSet set;

  Result<ToolModel> operator()(const ImplicitShape& shape) const {
    ToolModel model;
    model.distance = make_signed_distance(shape);
    model.extent_m = extent_of(model.distance->bounds());
    return model;
  }

  Result<ToolModel> operator()(const MeshSolid& solid) const {
    if (body.soft) return soft_model(make_soft_mesh(solid, *body.soft, set));
    ToolModel model;
    model.distance = std::make_shared<MeshDistance>(solid.mesh);
    model.extent_m = extent_of(model.distance->bounds());
    return model;
  }

  Result<ToolModel> operator()(const SurfaceSolid& solid) const {
    ToolModel model;
    if (body.soft) {
      return soft_model(
          make_body_state({"tool", solid.surface, body.soft->material, body.soft->lattice}, {}, set));
    }
    Result<NestedGrid> nested = make_nested_grid(solid.surface.u, solid.surface.v, levels);
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

  // One that gives way, held by the hand.
  Result<ToolModel> soft_model(Result<BodyState> soft) const {
    if (!soft.ok()) return Error{"tool: " + soft.error().message};
    // The hand carries the lattice's own nodes.
    soft->set_core(std::nullopt);
    soft->held = nodes_behind(soft->lattice, {body.soft->grip});
    ToolModel model;
    const LatticeMesh& mesh = soft->lattice.mesh();
    bool holds_any = false;
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (soft->held[static_cast<std::size_t>(n)] == 0) continue;
      const auto [i, j, k] = mesh.place(n);
      holds_any |= mesh.place_of(i, j, k) != NodePlace::beside_body;
      model.gripped.push_back(n);
    }
    if (!holds_any) return Error{"tool: its grip plane holds none of its nodes, move it"};
    if (soft->mesh()) model.triangles = soft->mesh()->triangles();
    soft->lattice.hold(soft->held);
    model.soft = std::move(soft).value();
    return model;
  }
};

}  // namespace

Result<ToolModel> make_tool_model(const Tool& tool, InstructionSet set) {
  SPOONBILL_ASSERT(tool.kind != ToolKind::solid || tool.body != nullptr);
  if (tool.kind != ToolKind::solid) return ToolModel{};
  return std::visit(ModelOf{*tool.body, set}, tool.body->solid);
}

}  // namespace spoonbill
