// Rigid meshes in FCL's trees of boxes, which find distances and crossing triangles, and posed meshes, which
// consist of several rigid meshes. Queries allocate, so they are for loading, checks and reports, not for the
// tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Unit and origin of the coordinates in which FCL computes. FCL's triangle distance treats normals below an
// absolute length as zero; the scale keeps the normals of all triangles above that length.
struct RigidScale {
  Vector3 origin_m = Vector3::Zero();
  double per_m = 1.0;
};
// Returns the scale for two meshes that are tested against each other.
RigidScale scale_for(const TriangleMesh& first, const TriangleMesh& second);

// Triangles in FCL's tree of boxes. FCL tests surfaces only, so a mesh that is entirely inside another does
// not count as touching it. Immutable; any thread may query it.
class RigidMesh {
 public:
  // `triangles` must not be empty. Their corners are vertex indices that start at `first_vertex`.
  RigidMesh(std::span<const Vector3> vertices_m, std::span<const TriangleCorners> triangles,
            std::uint32_t first_vertex, const RigidScale& scale);
  ~RigidMesh();
  RigidMesh(RigidMesh&&) noexcept;
  RigidMesh& operator=(RigidMesh&&) noexcept;

  struct Nearest {
    double distance_m = 0.0;  // 0 if triangles cross or touch
    Vector3 first_m = Vector3::Zero(), second_m = Vector3::Zero();
  };
  // Returns the nearest points of this mesh and another if they are nearer than `below_m`. Both meshes must
  // have the same scale.
  std::optional<Nearest> nearest(const RigidMesh& other, double below_m) const;

  // Returns at most about `limit` pairs of crossing or touching triangles, sorted. A pair has the index of a
  // triangle of this mesh and of a triangle of the other. Both meshes must have the same scale.
  using Crossing = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Crossing> find_crossings(const RigidMesh& other, std::size_t limit) const;

 private:
  struct Tree;  // defined in the source, to hide FCL's headers
  std::unique_ptr<Tree> tree_;
};

// A posed mesh of several parts, each with its box and FCL tree. Closed parts are solid; open parts are
// plates. Immutable after make_rigid(), so that any thread may read it.
class PosedMesh {
 public:
  // `mesh` must have at least one part, and `thickness_m` must be positive.
  PosedMesh(CleanMesh mesh, const Pose& pose, double thickness_m);

  // Builds the FCL tree of each part. Must be called before rigid().
  void make_rigid(const RigidScale& scale);

  const CleanMesh& clean() const { return mesh_; }
  const TriangleMesh& triangles() const { return mesh_.mesh; }
  const std::vector<MeshPart>& parts() const { return mesh_.parts; }
  const Vector3& vertex(std::uint32_t v) const { return mesh_.mesh.vertices_m[v]; }
  const TriangleCorners& corners(std::uint32_t t) const { return mesh_.mesh.triangles[t]; }
  std::size_t vertex_count() const { return mesh_.mesh.vertices_m.size(); }
  std::size_t triangle_count() const { return mesh_.mesh.triangles.size(); }
  std::uint32_t part_of_vertex(std::uint32_t v) const { return part_of_vertex_[v]; }

  // Returns the distance between a part's surface and its triangles: half the thickness of a plate, otherwise
  // 0.
  double half_thickness_m(std::size_t part) const {
    return mesh_.parts[part].closed ? 0.0 : half_thickness_m_;
  }
  double half_thickness_at_m(std::uint32_t v) const { return half_thickness_m(part_of_vertex_[v]); }
  bool has_plates() const { return has_plates_; }

  const std::vector<Box>& boxes() const { return boxes_; }  // one box around the surface of each part
  const RigidMesh& rigid(std::size_t part) const { return rigid_[part]; }
  // Returns the length of a part along a unit direction, in metres.
  double length_along(std::size_t part, const Vector3& direction) const;

 private:
  CleanMesh mesh_;
  double half_thickness_m_;
  bool has_plates_ = false;
  std::vector<std::uint32_t> part_of_vertex_;
  std::vector<Box> boxes_;
  std::vector<RigidMesh> rigid_;
};

}  // namespace spoonbill
