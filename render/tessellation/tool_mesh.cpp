#include "render/tessellation/tool_mesh.h"

#include <Eigen/Geometry>
#include <utility>

#include "engine/base/geometry.h"
#include "render/overlay/solid_tool.h"
#include "render/tessellation/shape_mesh.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

// A surface is cut as if it were that large on the screen.
constexpr double surface_px = 1500.0;

using Corners = std::array<Eigen::Vector3f, 3>;

void add_flat(const Corners& corners, ToolMesh& mesh) {
  const Eigen::Vector3f across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  // Thinner than single precision can tell.
  if (!(across.squaredNorm() > 0.0F)) return;
  for (const Eigen::Vector3f& corner : corners) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back({corner, across.normalized()});
  }
}

SurfaceSnapshot snapshot_of(const Surface& surface) {
  SurfaceSnapshot snapshot{surface.u, surface.v, 0, {}, {}, {}};
  snapshot.x.assign(surface.net.x.begin(), surface.net.x.end());
  snapshot.y.assign(surface.net.y.begin(), surface.net.y.end());
  snapshot.z.assign(surface.net.z.begin(), surface.net.z.end());
  return snapshot;
}

struct MeshOfSolid {
  Result<ToolMesh> operator()(const ImplicitShape& shape) const { return make_shape_mesh(shape); }

  Result<ToolMesh> operator()(const MeshSolid& solid) const {
    const TriangleMesh& triangles = solid.mesh.mesh;
    ToolMesh mesh;
    for (const MeshPart& part : solid.mesh.parts) {
      for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
        Corners corners;
        for (std::size_t c = 0; c < 3; ++c) {
          corners[c] = triangles.vertices_m[triangles.triangles[t][c]].cast<float>();
        }
        add_flat(corners, mesh);
        if (!part.closed) add_flat({corners[0], corners[2], corners[1]}, mesh);
      }
    }
    return mesh;
  }

  Result<ToolMesh> operator()(const SurfaceSolid& solid) const {
    const SurfaceSnapshot snapshot = snapshot_of(solid.surface);
    const Box box = bounding_box(ToolSolid(solid));
    const double pixels_per_metre = surface_px / box.size();
    TessellatedSurface surface;
    const Status updated = surface.update(snapshot, choose_sampling_level(snapshot, pixels_per_metre, {}));
    if (!updated) return Error{"tool: " + updated.error().message};
    ToolMesh mesh;
    const GridSamples<float>& at = surface.samples();
    for (std::size_t i = 0; i < surface.vertex_count(); ++i) {
      mesh.vertices.push_back({{at.x[i], at.y[i], at.z[i]}, {at.nx[i], at.ny[i], at.nz[i]}});
    }
    mesh.indices = surface.indices();
    return mesh;
  }
};

}  // namespace

Result<ToolMesh> make_tool_mesh(const ToolSolid& solid) {
  return std::visit(MeshOfSolid{}, solid);
}

}  // namespace spoonbill
