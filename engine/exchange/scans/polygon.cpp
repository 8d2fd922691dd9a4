#include "engine/exchange/scans/polygon.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Number of ears tested per corner. When all tests are used up, the rest of the polygon is cut without tests.
constexpr std::size_t tests_per_corner = 64;

// Returns twice the area vector of the polygon (Newell 1972).
Vector3 area_vector(std::span<const std::uint32_t> corners, const std::vector<Vector3>& points) {
  const Vector3 origin = points[corners[0]];
  Vector3 area = Vector3::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    area += (points[corners[k]] - origin).cross(points[corners[k + 1]] - origin);
  }
  return area;
}

double cross(const Vector2& a, const Vector2& b, const Vector2& c) {
  const Vector2 ab = b - a, ac = c - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

// A corner that remains to be cut: its index, and its position in the polygon's plane, where the polygon runs
// counter-clockwise.
struct PlaneCorner {
  std::uint32_t index = 0;
  Vector2 at = Vector2::Zero();
};

bool is_ear(const std::vector<PlaneCorner>& corners, std::size_t k) {
  const std::size_t count = corners.size(), before = (k + count - 1) % count, after = (k + 1) % count;
  const Vector2 &a = corners[before].at, &b = corners[k].at, &c = corners[after].at;
  if (!(cross(a, b, c) > 0.0)) return false;
  for (std::size_t other = 0; other < count; ++other) {
    const Vector2& at = corners[other].at;
    // Corners at the same position are two copies of one end of a bridge to a hole. They do not block an ear.
    if (other == before || other == k || other == after || at == a || at == b || at == c) continue;
    if (cross(a, b, at) >= 0.0 && cross(b, c, at) >= 0.0 && cross(c, a, at) >= 0.0) return false;
  }
  return true;
}

std::vector<PlaneCorner> place_in_plane(std::span<const std::uint32_t> corners,
                                        const std::vector<Vector3>& points) {
  const Vector3 area = area_vector(corners, points);
  Eigen::Index axis = 0;
  area.cwiseAbs().maxCoeff(&axis);
  const double sign = area[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<PlaneCorner> placed;
  placed.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Vector3& point = points[corner];
    placed.push_back({corner, {point[(axis + 1) % 3], sign * point[(axis + 2) % 3]}});
  }
  return placed;
}

}  // namespace

void cut_polygon(std::span<const std::uint32_t> corners, const std::vector<Vector3>& points,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
  SPOONBILL_ASSERT(corners.size() >= 3);
  if (corners.size() == 3) {
    triangles.push_back({corners[0], corners[1], corners[2]});
    return;
  }
  std::vector<PlaneCorner> remaining = place_in_plane(corners, points);
  std::size_t tests = tests_per_corner * corners.size(), k = 1, failed = 0;
  while (remaining.size() > 3) {
    const std::size_t count = remaining.size();
    k %= count;
    const bool must_cut = failed == count || tests == 0;
    if (!must_cut) --tests;
    if (!must_cut && !is_ear(remaining, k)) {
      ++failed;
      ++k;
      continue;
    }
    triangles.push_back(
        {remaining[(k + count - 1) % count].index, remaining[k].index, remaining[(k + 1) % count].index});
    remaining.erase(remaining.begin() + static_cast<std::ptrdiff_t>(k));
    failed = 0;
  }
  triangles.push_back({remaining[0].index, remaining[1].index, remaining[2].index});
}

}  // namespace spoonbill
