#include "engine/collision/proximity/nearest_on_cell.h"

#include <algorithm>
#include <array>

namespace spoonbill {
namespace {

// The point of a triangle nearest to `point`, as shares of its edges from the first corner. Unlike
// nearest_on_triangle.h, of triangles without an area too, which cells have at poles.
std::array<double, 2> shares_of_nearest(const Vector3& point, const Vector3& corner, const Vector3& edge_a,
                                        const Vector3& edge_b) {
  const Vector3 apart = point - corner;
  const double aa = edge_a.squaredNorm(), ab = edge_a.dot(edge_b), bb = edge_b.squaredNorm();
  const double pa = apart.dot(edge_a), pb = apart.dot(edge_b);
  const double determinant = aa * bb - ab * ab;
  const double s = determinant > 0.0 ? (bb * pa - ab * pb) / determinant : -1.0;
  const double t = determinant > 0.0 ? (aa * pb - ab * pa) / determinant : -1.0;
  if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) return {s, t};
  const auto share = [](double along, double square) {
    return square > 0.0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  };
  const double on_a = share(pa, aa), on_b = share(pb, bb);
  const Vector3 across = edge_b - edge_a;
  const double on_c = share((apart - edge_a).dot(across), across.squaredNorm());
  const std::array<std::array<double, 2>, 3> candidates = {{{on_a, 0.0}, {0.0, on_b}, {1.0 - on_c, on_c}}};
  return *std::min_element(candidates.begin(), candidates.end(), [&](const auto& one, const auto& other) {
    return (apart - one[0] * edge_a - one[1] * edge_b).squaredNorm() <
           (apart - other[0] * edge_a - other[1] * edge_b).squaredNorm();
  });
}

}  // namespace

OnCell nearest_on_cell(const Vector3& point, const PatchCorners& at) {
  const auto [a, b] = shares_of_nearest(point, at[0], at[2] - at[0], at[1] - at[0]);
  const OnCell low{a, b, (point - at[0] - a * (at[2] - at[0]) - b * (at[1] - at[0])).norm()};
  const auto [c, d] = shares_of_nearest(point, at[3], at[1] - at[3], at[2] - at[3]);
  const OnCell high{1.0 - c, 1.0 - d, (point - at[3] - c * (at[1] - at[3]) - d * (at[2] - at[3])).norm()};
  return low.distance <= high.distance ? low : high;
}

}  // namespace spoonbill
