// The distance to one closed part of a mesh, or to its sheets.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/meshes/winding_number.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// Never changes once made; distance() allocates nothing.
class ShellDistance {
 public:
  // The triangles name vertices among these alone.
  enum class Kind : std::uint8_t { solid, cavity, sheets };
  ShellDistance(std::vector<Vector3> vertices_m, std::vector<TriangleCorners> triangles, Kind kind);

  ShellDistance(ShellDistance&& other) noexcept = delete;

  // To the nearest point of the nearest triangle. Solids: negative inside; cavities: negative outside, where
  // the material is; sheets: never negative.
  DistanceSample at(const Vector3& point_m) const;

  // Which of the triangles, as they were given, the point is nearest to.
  std::uint32_t nearest_triangle(const Vector3& point_m) const;

  const Box& bounds() const { return tree_.nodes()[0].box; }

  // Whether the side is told by the normals of faces, edges and vertices, the latter weighted by angles
  // (Baerentzen and Aanaes 2005): for manifolds that do not meet themselves, at most `checked_triangles` of
  // them. Otherwise the winding number tells, at twice the time or more.
  bool is_told_by_normals() const { return !corner_normals_.empty(); }

  // All vertices behind all faces, to a ten-millionth of the size; false also where that was not tried.
  bool is_convex() const;

  static constexpr std::size_t checked_triangles = 1'000'000;

 private:
  struct Nearest;
  Nearest nearest(const Vector3& point) const;
  bool is_behind(const Nearest& nearest, const Vector3& point) const;
  Vector3 face_normal(std::uint32_t triangle) const;
  Vector3 normal_at(const Nearest& nearest) const;
  void take_normals();

  std::vector<Vector3> vertices_m_;
  BoxTree tree_;
  std::vector<TriangleCorners> triangles_;  // in the order of the tree's leaves
  Kind kind_;
  double size_m_;
  std::vector<std::uint32_t> across_;    // the triangle beyond each side
  std::vector<Vector3> corner_normals_;  // of each vertex, of any length
  std::optional<WindingNumber> winding_;
};

}  // namespace spoonbill
