#include "engine/collision/stages/contact_stages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {

namespace {

// Number of grid steps along the longest side of the points' box. Six times the volume of a tetrahedron is a
// sum of six products of three differences. With this number of steps, it stays below 2^63.
constexpr double steps_a_side = 1 << 20;

// Smallest bend at which an edge of the hull is drawn. Edges within nearly flat sides are omitted, because
// they depend on rounding.
constexpr double least_bend_rad = 0.5 * std::numbers::pi / 180.0;

using Steps = Eigen::Matrix<std::int64_t, 3, 1>;
using Edge = std::array<int, 2>;
using HullFace = std::array<int, 3>;

std::vector<Steps> round_points(const std::vector<Vector3>& points_m) {
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
    const Vector3 scaled = (point - box.low) * (steps_a_side / side);
    steps.emplace_back(std::llround(scaled.x()), std::llround(scaled.y()), std::llround(scaled.z()));
  }
  return steps;
}

// Incremental convex hull. A point in the plane of a triangle does not see the triangle, as if it were
// slightly inside. The border of the visible triangles is therefore one closed loop.
class HullBuilder {
 public:
  explicit HullBuilder(const std::vector<Steps>& points) : points_(points) {}

  bool start();
  void add(int point);
  std::vector<HullFace> faces() const;
  std::vector<Edge> edges() const;

 private:
  struct Plane {
    HullFace face;
    Steps normal;  // outward normal, not normalised
  };

  Steps face_normal(const HullFace& face) const {
    const Steps& a = points_[face[0]];
    return (points_[face[1]] - a).cross(points_[face[2]] - a);
  }
  // Returns six times the volume of the tetrahedron that the triangle and the point form. It is positive if
  // the point sees the triangle.
  std::int64_t volume(const Plane& plane, int point) const {
    return plane.normal.dot(points_[point] - points_[plane.face[0]]);
  }
  void add_face(const HullFace& face) { planes_.push_back({face, face_normal(face)}); }
  template <class Measure>
  int farthest(const Measure& measure) const;

  const std::vector<Steps>& points_;
  std::vector<Plane> planes_;
};

template <class Measure>
int HullBuilder::farthest(const Measure& measure) const {
  int best = 0;
  for (int k = 1; k < static_cast<int>(points_.size()); ++k) {
    if (measure(k) > measure(best)) best = k;
  }
  return best;
}

// Makes the first tetrahedron, from points far apart. Returns false if all points are in one plane.
bool HullBuilder::start() {
  const auto offset = [&](int a, int b) -> Eigen::Vector3d {
    return (points_[b] - points_[a]).cast<double>();
  };
  const int a = farthest([&](int k) { return -static_cast<double>(points_[k].x()); });
  const int b = farthest([&](int k) { return offset(a, k).squaredNorm(); });
  const int c = farthest([&](int k) { return offset(a, b).cross(offset(a, k)).squaredNorm(); });
  const Plane base{{a, b, c}, face_normal({a, b, c})};
  const int d = farthest([&](int k) { return std::abs(volume(base, k)); });
  const std::int64_t height = volume(base, d);
  if (height == 0) return false;
  const HullFace up = height < 0 ? HullFace{a, b, c} : HullFace{a, c, b};
  add_face(up);
  for (int k = 0; k < 3; ++k) add_face({up[(k + 1) % 3], up[k], d});
  return true;
}

void HullBuilder::add(int point) {
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

std::vector<HullFace> HullBuilder::faces() const {
  std::vector<HullFace> faces;
  for (const Plane& plane : planes_) faces.push_back(plane.face);
  return faces;
}

std::vector<Edge> HullBuilder::edges() const {
  std::map<Edge, Eigen::Vector3d> normals;  // normal of the triangle to the left of each directed edge
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
  const std::vector<Steps> steps = round_points(points_m);
  if (steps.empty()) return {};
  HullBuilder builder(steps);
  if (!builder.start()) return {};
  for (int k = 0; k < static_cast<int>(steps.size()); ++k) builder.add(k);
  return {builder.faces(), builder.edges()};
}

void add_hull(const ControlNet& net, ContactStages& stages) {
  SPOONBILL_ASSERT(net.z.size() == net.size());
  std::vector<Vector3> points;
  for (std::size_t k = 0; k < net.size(); ++k) points.emplace_back(net.x[k], net.y[k], net.z[k]);
  for (const auto& [a, b] : hull_facets(points).edges) {
    append(StageLine{points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]}, stages.hulls,
           stages);
  }
}

// Adds the deviation of the bilinear patch from its two triangles to the bulge. The patch deviates most at
// its centre, by a quarter of the corners' deviation from a parallelogram.
double triangle_slack(SurfaceLevels& levels, const LevelCell& cell) {
  const PatchCorners at = levels.corners(cell);
  return levels.bulge(cell) + 0.25 * (at[0] + at[3] - at[1] - at[2]).norm();
}

std::array<Triangle, 2> cell_triangles(const PatchCorners& at) {
  return {{{at[0], at[2], at[1]}, {at[3], at[1], at[2]}}};
}

void ElementMarks::add_border(int i, int j, int row_step, int column_step, ContactStages& stages) const {
  const int columns = levels_.nested().grid.columns();
  for (int k = 0; k < levels_.step(0); ++k) {
    const int from = (i + k * row_step) * columns + j + k * column_step;
    append(StageLine{levels_.sample(from), levels_.sample(from + row_step * columns + column_step)},
           stages.ranges, stages);
  }
}

void ElementMarks::add_to(ContactStages& stages) const {
  stages.elements += rows_ * columns_;
  const int stride = levels_.step(0);
  visit([&](const LevelCell& element) {
    ++stages.elements_within;
    const int row = element.i / stride, column = element.j / stride;
    if (!is_within(row - 1, column)) add_border(element.i, element.j, 0, 1, stages);
    if (!is_within(row + 1, column)) add_border(element.i + stride, element.j, 0, 1, stages);
    if (!is_within(row, column - 1)) add_border(element.i, element.j, 1, 0, stages);
    if (!is_within(row, column + 1)) add_border(element.i, element.j + stride, 1, 0, stages);
  });
}

}  // namespace spoonbill
