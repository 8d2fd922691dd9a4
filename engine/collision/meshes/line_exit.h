// Where a line comes out of a body of triangles. Outside the tick; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {

struct LineExit {
  double distance_m = 0.0;
  std::uint32_t triangle = 0;
  double to_b = 0.0, to_c = 0.0;  // the place in it, from a on the way to b and to c
};

// One owner. Immutable once made.
class LineExits {
 public:
  // Counter-clockwise seen from outside; at least one.
  explicit LineExits(std::vector<Triangle> triangles);

  // The nearest triangle along the unit direction that faces the same way as the line, whatever enters
  // through others before.
  std::optional<LineExit> first(const Vector3& from, const Vector3& direction) const;

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const BoxTree& tree() const { return *tree_; }

 private:
  std::vector<Triangle> triangles_;
  std::unique_ptr<BoxTree> tree_;
};

// Whether a line that goes out there leaves a wall: within 50 degrees of the triangle's normal. What it meets
// more askew is beside an edge, whose sides are as near to each other as one likes, however thick the body.
bool leaves_a_wall(const Triangle& triangle, const Vector3& direction);

}  // namespace spoonbill
