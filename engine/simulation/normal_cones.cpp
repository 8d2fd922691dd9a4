#include "engine/simulation/normal_cones.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/simulation/contact_samples.h"

namespace spoonbill {
namespace {

// A cone's angle is larger than that to the samples around by this angle, rad. On a flat face, contacts may
// deviate from the normal by no more, so that an edge that slides over the face is hardly held back.
constexpr double margin_rad = 5e-4;

// Returns the cosine of an angle with this cosine plus the margin.
double widened_cosine(double cosine) {
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double widened = (1.0 - 0.5 * margin_rad * margin_rad) * cosine - margin_rad * sine;
  return sine < margin_rad && cosine < 0.0 ? -1.0 : widened;  // the cone includes every direction
}

}  // namespace

NormalCones::NormalCones(const BodyMapping& mapping, bool has_far_face) : has_far_face_(has_far_face) {
  const Grid& grid = mapping.nested().grid;
  const Surface& rest = mapping.rest();
  const int rows = grid.rows(), columns = grid.columns();
  cones_.resize(static_cast<std::size_t>(rows * columns));
  const auto cone_at = [&](int i, int j) -> Cone& {
    return cones_[static_cast<std::size_t>(i * columns + j)];
  };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      cone_at(i, j).axis = unit_normal(rest, grid.u.parameters[static_cast<std::size_t>(i)],
                                       grid.v.parameters[static_cast<std::size_t>(j)]);
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      Cone& cone = cone_at(i, j);
      double least = 1.0;
      for (const int row : find_neighbours(i, rows, rest.u.is_periodic()))
        least = std::min(least, cone.axis.dot(cone_at(row, j).axis));
      for (const int column : find_neighbours(j, columns, rest.v.is_periodic()))
        least = std::min(least, cone.axis.dot(cone_at(i, column).axis));
      cone.least_cosine = widened_cosine(least);
    }
  }
}

NormalCones::NormalCones(const MeshMapping& mapping) {
  const std::vector<Vector3>& vertices_m = mapping.rest_m();
  const auto area_vector = [&](const TriangleCorners& corners) -> Vector3 {
    const Vector3& first = vertices_m[corners[0]];
    return (vertices_m[corners[1]] - first).cross(vertices_m[corners[2]] - first);
  };
  std::vector<Vector3> sums(vertices_m.size(), Vector3::Zero());
  for (const TriangleCorners& corners : mapping.current().triangles()) {
    for (const std::uint32_t corner : corners) sums[corner] += area_vector(corners);
  }
  cones_.resize(vertices_m.size());
  for (std::size_t v = 0; v < cones_.size(); ++v) cones_[v] = {sums[v].normalized(), 1.0};
  for (const TriangleCorners& corners : mapping.current().triangles()) {
    const Vector3 normal = area_vector(corners).normalized();
    for (const std::uint32_t corner : corners) {
      cones_[corner].least_cosine = std::min(cones_[corner].least_cosine, cones_[corner].axis.dot(normal));
    }
  }
  for (Cone& cone : cones_) cone.least_cosine = widened_cosine(cone.least_cosine);
}

}  // namespace spoonbill
