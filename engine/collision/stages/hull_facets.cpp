#include "engine/collision/stages/hull_facets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

// Products of three differences then stay below 2^63.
constexpr double steps_a_side = 1 << 20;

// How nearly flat sides are cut to triangles depends on the last digits of their points, and nobody sees it.
constexpr double least_bend_rad = 0.5 * std::numbers::pi / 180.0;

using Steps = Eigen::Matrix<std::int64_t, 3, 1>;
using Edge = std::array<int, 2>;
using Face = std::array<int, 3>;

std::vector<Steps> rounded(const std::vector<Vector3>& points_m) {
  Box box;
  for (const Vector3& point : points_m) {
    if (!point.allFinite()) return {};
    box.include(point);
  }
  const double side = box.extent().maxCoeff();
  if (!(side > 0.0) || !std::isfinite(steps_a_side / side)) return {};
  std::vector<Steps> steps;
  steps.reserve(points_m.size());
  for (const Vector3& point : points_m) {
    const Vector3 share = (point - box.low) * (steps_a_side / side);
    steps.emplace_back(std::llround(share.x()), std::llround(share.y()), std::llround(share.z()));
  }
  return steps;
}

// Adds one point after another. A point in the plane of a triangle does not see it: the triangles that it
// sees are then those that a point just inside of such planes sees, and their border is one closed way.
class Builder {
 public:
  explicit Builder(const std::vector<Steps>& points) : points_(points) {}

  bool start();
  void add(int point);
  std::vector<Face> faces() const;
  std::vector<Edge> edges() const;

 private:
  struct Plane {
    Face face;
    Steps normal;  // outward
  };

  Steps normal_of(const Face& face) const {
    const Steps& a = points_[face[0]];
    return (points_[face[1]] - a).cross(points_[face[2]] - a);
  }
  // Six times the volume between the triangle and the point, positive where the point sees it.
  std::int64_t volume(const Plane& plane, int point) const {
    return plane.normal.dot(points_[point] - points_[plane.face[0]]);
  }
  void add_face(const Face& face) { planes_.push_back({face, normal_of(face)}); }
  template <class Measure>
  int farthest(const Measure& measure) const;

  const std::vector<Steps>& points_;
  std::vector<Plane> planes_;
};

template <class Measure>
int Builder::farthest(const Measure& measure) const {
  int best = 0;
  for (int k = 1; k < static_cast<int>(points_.size()); ++k) {
    if (measure(k) > measure(best)) best = k;
  }
  return best;
}

// A tetrahedron of points far from each other; false where there is none.
bool Builder::start() {
  const auto apart = [&](int a, int b) -> Eigen::Vector3d {
    return (points_[b] - points_[a]).cast<double>();
  };
  const int a = farthest([&](int k) { return -static_cast<double>(points_[k].x()); });
  const int b = farthest([&](int k) { return apart(a, k).squaredNorm(); });
  const int c = farthest([&](int k) { return apart(a, b).cross(apart(a, k)).squaredNorm(); });
  const Plane base{{a, b, c}, normal_of({a, b, c})};
  const int d = farthest([&](int k) { return std::abs(volume(base, k)); });
  const std::int64_t height = volume(base, d);
  if (height == 0) return false;
  const Face up = height < 0 ? Face{a, b, c} : Face{a, c, b};
  add_face(up);
  for (int k = 0; k < 3; ++k) add_face({up[(k + 1) % 3], up[k], d});
  return true;
}

void Builder::add(int point) {
  std::map<Edge, int> seen;  // directed edges of the triangles that the point sees
  for (const Plane& plane : planes_) {
    if (volume(plane, point) <= 0) continue;
    for (int k = 0; k < 3; ++k) seen[{plane.face[k], plane.face[(k + 1) % 3]}] = 1;
  }
  if (seen.empty()) return;
  std::erase_if(planes_, [&](const Plane& plane) { return volume(plane, point) > 0; });
  for (const auto& [edge, ignored] : seen) {
    if (!seen.contains({edge[1], edge[0]})) add_face({edge[0], edge[1], point});
  }
}

std::vector<Face> Builder::faces() const {
  std::vector<Face> faces;
  for (const Plane& plane : planes_) faces.push_back(plane.face);
  return faces;
}

std::vector<Edge> Builder::edges() const {
  std::map<Edge, Eigen::Vector3d> normals;  // of the triangle to the left of each directed edge
  for (const Plane& plane : planes_) {
    const Eigen::Vector3d normal = plane.normal.cast<double>().normalized();
    for (int k = 0; k < 3; ++k) normals[{plane.face[k], plane.face[(k + 1) % 3]}] = normal;
  }
  std::vector<Edge> edges;
  for (const auto& [edge, normal] : normals) {
    if (edge[0] > edge[1]) continue;
    const Eigen::Vector3d& other = normals.at({edge[1], edge[0]});
    if (std::atan2(normal.cross(other).norm(), normal.dot(other)) > least_bend_rad) edges.push_back(edge);
  }
  return edges;
}

}  // namespace

HullFacets hull_facets(const std::vector<Vector3>& points_m) {
  if (points_m.size() < 4) return {};
  const std::vector<Steps> steps = rounded(points_m);
  if (steps.empty()) return {};
  Builder builder(steps);
  if (!builder.start()) return {};
  for (int k = 0; k < static_cast<int>(steps.size()); ++k) builder.add(k);
  return {builder.faces(), builder.edges()};
}

}  // namespace spoonbill
