#include "engine/material/rigid/rigid_mass.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/bspline/quadrature.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {
namespace {

// Sums of mass, about an origin near the body.
struct MassSums {
  double mass_kg = 0.0;
  Vector3 first_kg_m = Vector3::Zero();
  Eigen::Matrix3d second_kg_m2 = Eigen::Matrix3d::Zero();

  std::optional<RigidMass> find_mass(const Vector3& origin) const {
    if (!(mass_kg > 0.0)) return std::nullopt;
    RigidMass mass{mass_kg, origin + first_kg_m / mass_kg};
    const Eigen::Matrix3d about_centre = second_kg_m2 - first_kg_m * first_kg_m.transpose() / mass_kg;
    mass.inertia_kg_m2 = about_centre.trace() * Eigen::Matrix3d::Identity() - about_centre;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(mass.inertia_kg_m2,
                                                                   Eigen::EigenvaluesOnly);
    const Vector3 inertias = principal.eigenvalues();
    if (!(inertias.x() > 1e-9 * inertias.z())) return std::nullopt;
    return mass;
  }
};

// Sums over the cones from the origin to the surface. By the divergence theorem, the integral of a polynomial
// of degree n over a cone is 3 / (n + 3) times the cone's volume times the polynomial's value at its base.
MassSums sum_solid(const Surface& surface, double density_kg_per_m3) {
  const Vector3 origin = surface.net.point(0, 0);
  // Along a direction of degree p, the integrand of the second moment has degree 5 p - 1.
  const auto quadrature = [](const KnotVector& knots) {
    return make_piece_quadrature(knots, (5 * knots.degree() + 1) / 2);
  };
  const PieceQuadrature in_u = quadrature(surface.u), in_v = quadrature(surface.v);
  MassSums sums;
  for (std::size_t i = 0; i < in_u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < in_v.parameters.size(); ++j) {
      const SurfacePoint point = evaluate(surface, in_u.parameters[i], in_v.parameters[j]);
      const Vector3 offset = point.position_m - origin;
      const double weight = in_u.weights[i] * in_v.weights[j];
      const double cone_kg = density_kg_per_m3 * weight * offset.dot(point.du.cross(point.dv)) / 3.0;
      sums.mass_kg += cone_kg;
      sums.first_kg_m += 0.75 * cone_kg * offset;
      sums.second_kg_m2 += 0.6 * cone_kg * offset * offset.transpose();
    }
  }
  if (sums.mass_kg >= 0.0) return sums;
  return {-sums.mass_kg, -sums.first_kg_m, -sums.second_kg_m2};  // the normals point inwards
}

// Sums over the cones from the origin to the triangles, in the same way. Over a triangle with the corners a,
// b and c, the mean of x is (a + b + c) / 3, and that of x x^T is (a a^T + b b^T + c c^T + s s^T) / 12 with
// s = a + b + c. Cavities are oriented inward and are thus subtracted.
MassSums sum_mesh(const TriangleMesh& mesh, double density_kg_per_m3) {
  const Vector3 origin = mesh.vertices_m.front();
  MassSums sums;
  for (const TriangleCorners& corners : mesh.triangles) {
    const auto offset = [&](std::size_t c) { return Vector3(mesh.vertices_m[corners[c]] - origin); };
    const Vector3 a = offset(0), b = offset(1), c = offset(2), sum = a + b + c;
    const double cone_kg = density_kg_per_m3 * a.dot(b.cross(c)) / 6.0;
    sums.mass_kg += cone_kg;
    sums.first_kg_m += 0.25 * cone_kg * sum;
    sums.second_kg_m2 +=
        0.05 * cone_kg * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  return sums;
}

// Sums over the area of parallel surfaces: at depth s that area is dA (1 - 2 H s + K s^2) with the mean
// curvature H and the Gaussian curvature K (Steiner 1840). Gauss's rule over the thickness is exact here.
MassSums sum_shell(const Surface& surface, double thickness_m, const TrimmedArea& area,
                   double density_kg_per_m3) {
  const Vector3 origin = surface.net.point(0, 0);
  // Nodes and weights of Gauss's rule with three nodes, from -1 to 1.
  const double outer = std::sqrt(0.6);
  const std::array<double, 3> nodes = {-outer, 0.0, outer}, weights = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  MassSums sums;
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const Vector3 normal = point.du.cross(point.dv);
    const double first = normal.squaredNorm(), size = std::sqrt(first);
    if (!(first > 0.0)) return;
    const Vector3 unit = normal / size;
    const double uu = point.duu.dot(unit), uv = point.duv.dot(unit), vv = point.dvv.dot(unit);
    const double twice_mean =
        -(point.du.squaredNorm() * vv - 2.0 * point.du.dot(point.dv) * uv + point.dv.squaredNorm() * uu) /
        first;
    const double gaussian = (uu * vv - uv * uv) / first;
    for (std::size_t d = 0; d < nodes.size(); ++d) {
      const double depth = 0.5 * thickness_m * (1.0 + nodes[d]);
      const double area_m2 = weight * size * (1.0 - twice_mean * depth + gaussian * depth * depth);
      const double mass_kg = density_kg_per_m3 * 0.5 * thickness_m * weights[d] * area_m2;
      const Vector3 offset = point.position_m - origin - depth * unit;
      sums.mass_kg += mass_kg;
      sums.first_kg_m += mass_kg * offset;
      sums.second_kg_m2 += mass_kg * offset * offset.transpose();
    }
  });
  return sums;
}

}  // namespace

std::optional<RigidMass> compute_rigid_mass(const Body& body) {
  if (body.mesh) {
    const TriangleMesh mesh = find_placed_mesh(body);
    return sum_mesh(mesh, body.material.density_kg_per_m3).find_mass(mesh.vertices_m.front());
  }
  const auto trim = make_trimmed_area(body);
  if (!trim) return std::nullopt;
  const TrimmedArea area = trim.value() ? *trim.value() : TrimmedArea();
  const Vector3 origin = body.surface.net.point(0, 0);
  const double density = body.material.density_kg_per_m3;
  if (body.shell_thickness_m) {
    return sum_shell(body.surface, *body.shell_thickness_m, area, density).find_mass(origin);
  }
  if (!area.is_whole()) return std::nullopt;
  return sum_solid(body.surface, density).find_mass(origin);
}

}  // namespace spoonbill
