// The order in which glass is drawn: what faces the eye, the far before the near. No GL. One owner, one
// thread.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "render/tessellation/tool_mesh.h"

namespace spoonbill {

class FacingOrder {
 public:
  // The indices of the triangles whose outside the eye, in the mesh's frame, can see, by the distance of
  // their middles. Valid until the next call. Exact but for triangles that are long beside their distance
  // from each other.
  const std::vector<std::uint32_t>& of(const ToolMesh& mesh, const Eigen::Vector3f& eye_m);

 private:
  struct Facing {
    float distance_m;
    std::uint32_t first_index;
  };
  void find_facing(const ToolMesh& mesh, const Eigen::Vector3f& eye_m);
  std::uint32_t bucket_of(float distance_m) const;

  std::vector<Facing> facing_;
  std::vector<std::uint32_t> ends_;  // of each bucket's triangles, the farthest bucket first
  std::vector<std::uint32_t> indices_;
  float farthest_m_ = 0.0F, buckets_per_m_ = 0.0F;
};

}  // namespace spoonbill
