#include "engine/fitting/point_discs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "engine/base/assert.h"
#include "engine/fitting/point_sets.h"

namespace spoonbill {
namespace {

constexpr std::size_t neighbour_count = 7;  // of a point, itself included
constexpr std::uint32_t corner_count = 6;
// Radius in mean distances to the neighbours, with which the discs of scattered points leave few gaps.
constexpr double radius_fraction = 0.9;

// Returns the normal of the plane that fits the points best; the y axis if they are all in one place.
Vector3 plane_normal(const std::vector<Vector3>& points, const std::vector<NearestPoints::Neighbour>& of) {
  Vector3 mean = Vector3::Zero();
  for (const auto& neighbour : of) mean += points[neighbour.index];
  mean /= static_cast<double>(of.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& neighbour : of) {
    const Vector3 from_mean = points[neighbour.index] - mean;
    spread += from_mean * from_mean.transpose();
  }
  if (!(spread.trace() > 0.0)) return Vector3::UnitY();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
}

void append_disc(const Vector3& centre, const Vector3& normal, double radius, TriangleMesh& mesh) {
  const Vector3 along = normal.unitOrthogonal(), across = normal.cross(along);
  const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
  for (std::uint32_t corner = 0; corner < corner_count; ++corner) {
    const double angle = 2.0 * std::numbers::pi * corner / corner_count;
    mesh.vertices_m.push_back(centre + radius * (std::cos(angle) * along + std::sin(angle) * across));
  }
  for (std::uint32_t corner = 2; corner < corner_count; ++corner) {
    mesh.triangles.push_back({first, first + corner - 1, first + corner});
  }
}

}  // namespace

TriangleMesh make_point_discs(const Scan& cloud, std::size_t limit) {
  SPOONBILL_ASSERT(limit > 0 && (!cloud.has_normals() || cloud.normals.size() == cloud.points_m.size()));
  TriangleMesh mesh;
  if (cloud.points_m.empty()) return mesh;
  const std::size_t stride = (cloud.points_m.size() + limit - 1) / limit;
  std::vector<Vector3> points, normals;
  for (std::size_t i = 0; i < cloud.points_m.size(); i += stride) {
    points.push_back(cloud.points_m[i]);
    if (cloud.has_normals()) normals.push_back(cloud.normals[i]);
  }
  const NearestPoints nearest(points);
  std::vector<NearestPoints::Neighbour> around;
  for (std::size_t i = 0; i < points.size(); ++i) {
    nearest.nearest(points[i], neighbour_count, around);
    const bool has_normal = !normals.empty() && normals[i].squaredNorm() > 0.5;
    const Vector3 normal = has_normal ? normals[i].normalized() : plane_normal(points, around);
    double sum_m = 0.0;
    for (const auto& neighbour : around) sum_m += neighbour.distance;
    const double mean_m = sum_m / static_cast<double>(std::max<std::size_t>(1, around.size() - 1));
    append_disc(points[i], normal, radius_fraction * mean_m, mesh);
  }
  return mesh;
}

}  // namespace spoonbill
