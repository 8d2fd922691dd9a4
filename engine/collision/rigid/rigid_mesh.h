// Triangles that keep their shape, in FCL's tree of boxes: how far apart two of them are and which triangles
// cross. FCL tests surfaces alone: one inside the other is apart (FCL bug 492). For loading, checking and
// reports; never in the tick, for queries allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// The unit and the origin in which FCL computes. Its triangle distances treat triangles with a normal below
// an absolute size as if they had no area; a scale_for() both meshes keeps all triangles above it.
struct RigidScale {
  Vector3 origin_m = Vector3::Zero();
  double per_m = 1.0;
};
RigidScale scale_for(const TriangleMesh& first, const TriangleMesh& second);

// Immutable once made; any thread may query it.
class RigidMesh {
 public:
  // At least one triangle, whose corners name vertices from `first_vertex` on among those that follow it.
  RigidMesh(std::span<const Vector3> vertices_m, std::span<const TriangleCorners> triangles,
            std::uint32_t first_vertex, const RigidScale& scale);
  ~RigidMesh();
  RigidMesh(RigidMesh&&) noexcept;
  RigidMesh& operator=(RigidMesh&&) noexcept;

  struct Nearest {
    double distance_m = 0.0;  // 0 where triangles cross or touch
    Vector3 first_m = Vector3::Zero(), second_m = Vector3::Zero();
  };
  // The nearest points of both where they are nearer than `below_m`. Both meshes must have one scale.
  std::optional<Nearest> nearest(const RigidMesh& other, double below_m) const;

  // The triangles of this and of the other that cross or touch, by their places among those given; about
  // `most` of them at most. Both meshes must have one scale.
  using Crossing = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Crossing> find_crossings(const RigidMesh& other, std::size_t most) const;

 private:
  struct Tree;  // FCL's headers stay out of ours
  std::unique_ptr<Tree> tree_;
};

}  // namespace spoonbill
