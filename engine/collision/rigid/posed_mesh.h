// A mesh of several parts where a pose puts it, each part in FCL's tree of boxes and with the box about it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/rigid/rigid_mesh.h"

namespace spoonbill {

// Closed parts are solid, open ones plates. Immutable once make_rigid() was called; any thread may read it.
class PosedMesh {
 public:
  // `mesh` has at least one part.
  PosedMesh(CleanMesh mesh, const Pose& pose, double thickness_m);

  // Gives each part its tree; rigid() and find_gap() need it.
  void make_rigid(const RigidScale& scale);

  const CleanMesh& clean() const { return mesh_; }
  const TriangleMesh& triangles() const { return mesh_.mesh; }
  const std::vector<MeshPart>& parts() const { return mesh_.parts; }
  const Vector3& vertex(std::uint32_t v) const { return mesh_.mesh.vertices_m[v]; }
  const TriangleCorners& corners(std::uint32_t t) const { return mesh_.mesh.triangles[t]; }
  std::size_t vertex_count() const { return mesh_.mesh.vertices_m.size(); }
  std::size_t triangle_count() const { return mesh_.mesh.triangles.size(); }
  std::uint32_t part_of_vertex(std::uint32_t v) const { return part_of_vertex_[v]; }

  // How far the surface of a part is from its triangles: half the thickness of a plate.
  double grown_m(std::size_t part) const { return mesh_.parts[part].closed ? 0.0 : grown_m_; }
  double grown_at_m(std::uint32_t v) const { return grown_m(part_of_vertex_[v]); }
  bool has_plates() const { return has_plates_; }

  const std::vector<Box>& boxes() const { return boxes_; }  // about each part's surface
  const RigidMesh& rigid(std::size_t part) const { return rigid_[part]; }
  double length_along(std::size_t part, const Vector3& direction) const;

 private:
  CleanMesh mesh_;
  double grown_m_;
  bool has_plates_ = false;
  std::vector<std::uint32_t> part_of_vertex_;
  std::vector<Box> boxes_;
  std::vector<RigidMesh> rigid_;
};

}  // namespace spoonbill
