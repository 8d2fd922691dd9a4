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
// Spacing of points that are all in one place.
constexpr double lone_spacing_m = 1e-3;

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
  std::vector<double> spacings_m;  // mean distance of each point to those around it that are elsewhere
  std::vector<double> known_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    nearest.nearest(points[i], neighbour_count, around);
    double sum_m = 0.0;
    int elsewhere = 0;
    for (const auto& neighbour : around) {
      sum_m += neighbour.distance;
      elsewhere += neighbour.distance > 0.0 ? 1 : 0;
    }
    spacings_m.push_back(elsewhere > 0 ? sum_m / elsewhere : 0.0);
    if (elsewhere > 0) known_m.push_back(spacings_m.back());
    if (normals.size() <= i) normals.push_back(plane_normal(points, around));
    if (!(normals[i].squaredNorm() > 0.5)) normals[i] = plane_normal(points, around);
  }
  const double usual_m = known_m.empty() ? lone_spacing_m : median(known_m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double spacing_m =
        spacings_m[i] > 0.0 ? std::clamp(spacings_m[i], 0.5 * usual_m, 2.0 * usual_m) : usual_m;
    append_disc(points[i], normals[i].normalized(), radius_fraction * spacing_m, mesh);
  }
  return mesh;
}

}  // namespace spoonbill
