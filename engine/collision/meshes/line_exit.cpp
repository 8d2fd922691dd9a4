#include "engine/collision/meshes/line_exit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/line_triangle.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t leaf_size = 4;
// Of 50 degrees: neither the edges of 45 nor those of 60 that parts have are told by rounding.
constexpr double wall_cosine = 0.6428;

// By the slabs between its faces (Kay and Kajiya 1986).
bool meets(const Box& box, const Vector3& from, const Vector3& direction, double farthest) {
  double near = 0.0, far = farthest;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (from[axis] < box.low[axis] || from[axis] > box.high[axis]) return false;
      continue;
    }
    double enter = (box.low[axis] - from[axis]) / direction[axis];
    double leave = (box.high[axis] - from[axis]) / direction[axis];
    if (enter > leave) std::swap(enter, leave);
    near = std::max(near, enter);
    far = std::min(far, leave);
  }
  return near <= far;
}

}  // namespace

LineExits::LineExits(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  std::vector<Box> boxes;
  boxes.reserve(triangles_.size());
  for (const Triangle& triangle : triangles_) boxes.push_back(bounding_box(triangle));
  tree_ = std::make_unique<BoxTree>(boxes, leaf_size);
}

std::optional<LineExit> LineExits::first(const Vector3& from, const Vector3& direction) const {
  SPOONBILL_ASSERT_DEBUG(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  std::optional<LineExit> first;
  const auto farthest = [&] { return first ? first->distance_m : std::numeric_limits<double>::infinity(); };
  const auto descend = [&](std::uint32_t index) {
    return meets(tree_->nodes()[index].box, from, direction, farthest());
  };
  const auto look_at = [&](std::uint32_t place) {
    const Triangle& triangle = triangles_[place];
    constexpr double loose = 1e-6;  // so that a line along an edge meets one of its triangles
    const auto met = line_meets_triangle(from, direction, triangle[0], triangle[1], triangle[2], loose);
    if (!met || !(met->facing < 0.0) || !(met->along > 0.0) || !(met->along < farthest())) return;
    first = LineExit{met->along, place, met->to_b, met->to_c};
  };
  tree_->search(
      descend, [](std::uint32_t, std::uint32_t) { return false; },
      [&](std::uint32_t start, std::uint32_t count) {
        for (std::uint32_t k = 0; k < count; ++k) look_at(tree_->order()[start + k]);
      });
  return first;
}

bool leaves_a_wall(const Triangle& triangle, const Vector3& direction) {
  SPOONBILL_ASSERT_DEBUG(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  const Vector3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  return normal.dot(direction) >= wall_cosine * normal.norm() * direction.norm();
}

}  // namespace spoonbill
