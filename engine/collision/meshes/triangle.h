// Queries on triangles in double precision: intersection, nearest point, solid angle. The functions are pure
// and may be called from any thread.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "engine/base/geometry.h"

namespace spoonbill {

using Triangle = std::array<Vector3, 3>;

inline Box bounding_box(const Triangle& t) {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}

// Returns false only if a plane separates the triangles by more than `slack_m`. Pairs nearer than the slack
// always give true. Some pairs slightly farther apart, whose corners face each other, also give true,
// because only these separating directions are tested: both normals, the cross products of the edges and,
// for coplanar triangles, the in-plane directions across the edges.
bool triangles_meet(const Triangle& a, const Triangle& b, double slack_m = 0.0);

// Result of intersect_line_triangle().
struct LineTriangleHit {
  double along = 0.0;             // position on the line, as a multiple of its direction; may be negative
  double to_b = 0.0, to_c = 0.0;  // barycentric weights of the corners b and c
  double facing = 0.0;  // negative if the line passes through the triangle from its back to its front
};

// Intersects an infinite line with a triangle (Moeller and Trumbore 1997). Returns nothing if the line is
// parallel to the triangle, or misses it by more than `loose`, which is a fraction of the triangle's sides.
inline std::optional<LineTriangleHit> intersect_line_triangle(const Vector3& from, const Vector3& direction,
                                                              const Vector3& a, const Vector3& b,
                                                              const Vector3& c, double loose) {
  const Vector3 ab = b - a, ac = c - a, across = direction.cross(ac);
  const double facing = ab.dot(across);
  if (facing == 0.0) return std::nullopt;
  const Vector3 offset = from - a, offset_cross_ab = offset.cross(ab);
  const double to_b = offset.dot(across) / facing, to_c = direction.dot(offset_cross_ab) / facing;
  if (to_b < -loose || to_c < -loose || to_b + to_c > 1.0 + loose) return std::nullopt;
  return LineTriangleHit{ac.dot(offset_cross_ab) / facing, to_b, to_c, facing};
}

struct NearestOnTriangle {
  Vector3 point = Vector3::Zero();
  enum class On : std::uint8_t { face, side, corner } on = On::face;
  std::uint32_t which = 0;  // index of the side or corner; side k leads from corner k to the next corner
};

// Returns the nearest point of a triangle, found by the Voronoi regions of its corners, sides and face
// (Ericson 2005, 5.1.5). The area of the triangle must not be zero.
NearestOnTriangle nearest_on_triangle(const Vector3& a, const Vector3& b, const Vector3& c,
                                      const Vector3& point);

inline constexpr double full_solid_angle = 4.0 * 3.14159265358979323846;

// Returns the solid angle of the triangle a, b, c seen from the origin, in steradians (van Oosterom and
// Strackee 1983). The angle is positive if the triangle's back is visible. For a point inside a closed mesh
// with outward normals, the angles therefore sum to 4 pi. The angle is zero if the origin is in the
// triangle's plane.
inline double solid_angle(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return numerator == 0.0 ? 0.0 : 2.0 * std::atan2(numerator, denominator);
}

}  // namespace spoonbill
