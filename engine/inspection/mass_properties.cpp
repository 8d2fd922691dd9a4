#include "engine/inspection/mass_properties.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <set>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/inspection/curvature.h"
#include "engine/inspection/surface_check.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/lattice_materials.h"

namespace spoonbill {
namespace {

struct Quadrature {
  std::vector<double> nodes, weights;  // nodes and weights for the interval from -1 to 1
};

// Returns the Gauss-Legendre rule with `count` nodes. The nodes are the roots of the Legendre polynomial,
// found by Newton's method from Tricomi's estimate.
Quadrature gauss_legendre(int count) {
  Quadrature rule;
  for (int k = 0; k < count; ++k) {
    double x = std::cos(std::numbers::pi * (k + 0.75) / (count + 0.5)), slope = 1.0;
    for (int step = 0; step < 50; ++step) {
      double before = 1.0, value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = count * (x * value - before) / (x * x - 1.0);
      const double move = value / slope;
      x -= move;
      if (std::abs(move) < 1e-15) break;
    }
    rule.nodes.push_back(x);
    rule.weights.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

PieceQuadrature make_piece_quadrature(const KnotVector& knots, int nodes) {
  SPOONBILL_ASSERT(nodes >= 1);
  const Quadrature rule = gauss_legendre(nodes);
  const std::vector<double> pieces = knots.breakpoints();
  PieceQuadrature result;
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    const double half = 0.5 * (pieces[k + 1] - pieces[k]);
    for (std::size_t n = 0; n < rule.nodes.size(); ++n) {
      result.parameters.push_back(pieces[k] + half * (1.0 + rule.nodes[n]));
      result.weights.push_back(half * rule.weights[n]);
    }
  }
  return result;
}

namespace {

using Parameters = Eigen::Vector2d;

void visit_whole_surface(const Surface& surface, const AreaVisitor& visit) {
  const PieceQuadrature in_u = make_piece_quadrature(surface.u, 2 * surface.u.degree() + 1);
  const PieceQuadrature in_v = make_piece_quadrature(surface.v, 2 * surface.v.degree() + 1);
  for (std::size_t i = 0; i < in_u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < in_v.parameters.size(); ++j) {
      visit(evaluate(surface, in_u.parameters[i], in_v.parameters[j]), in_u.weights[i] * in_v.weights[j]);
    }
  }
}

// Visits the seven points of Radon's rule in a triangle of parameters: the centroid and, at each of two
// distances from it, three points on the medians.
void visit_triangle(const Surface& surface, const std::array<Parameters, 3>& corners,
                    const AreaVisitor& visit) {
  const Parameters first = corners[1] - corners[0], second = corners[2] - corners[0];
  const double size = 0.5 * (first.x() * second.y() - first.y() * second.x());
  if (!(size > 0.0)) return;
  const double root = std::sqrt(15.0);
  const Parameters centroid = (corners[0] + corners[1] + corners[2]) / 3.0;
  visit(evaluate(surface, centroid.x(), centroid.y()), 9.0 / 40.0 * size);
  for (const double sign : {-1.0, 1.0}) {
    const double fraction = (6.0 + sign * root) / 21.0, weight = (155.0 + sign * root) / 1200.0;
    for (const Parameters& corner : corners) {
      const Parameters point = 3.0 * fraction * centroid + (1.0 - 3.0 * fraction) * corner;
      visit(evaluate(surface, point.x(), point.y()), weight * size);
    }
  }
}

}  // namespace

void visit_area(const Surface& surface, const TrimmedArea& area, const AreaVisitor& visit) {
  SPOONBILL_ASSERT(static_cast<bool>(visit));
  if (area.is_whole()) return visit_whole_surface(surface, visit);
  const std::vector<double> u = nested_parameters(surface.u, 1, 1).parameters;
  const std::vector<double> v = nested_parameters(surface.v, 1, 1).parameters;
  const auto grid = make_grid(surface.u, surface.v, u, v);
  if (!grid) return visit_whole_surface(surface, visit);
  const TrimmedGrid trimmed = trim_grid(grid->u, grid->v, area);
  const auto parameters_at = [&](std::uint32_t vertex) -> Parameters {
    const std::size_t samples = u.size() * v.size();
    if (vertex < samples) return {u[vertex / v.size()], v[vertex % v.size()]};
    const CutVertex& cut = trimmed.vertices[vertex - samples];
    return {cut.u, cut.v};
  };
  for (const auto& [a, b, c] : trimmed.triangles)
    visit_triangle(surface, {parameters_at(a), parameters_at(b), parameters_at(c)}, visit);
}

EnclosedMass compute_enclosed_mass(const Surface& surface, const TrimmedArea& area) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  // Moments are taken about a control point, so that a large distance from the origin costs no precision.
  const Vector3 origin = surface.net.point(0, 0);
  EnclosedMass mass;
  // Along a direction of degree p, the integrand of the first moment has degree 4 p - 1.
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const Vector3 offset = point.position_m - origin;
    const Vector3 normal = weight * point.du.cross(point.dv);
    const double size = normal.norm(), cone = offset.dot(normal) / 3.0;
    mass.area_m2 += size;
    mass.area_centre_m += size * offset;
    mass.volume_m3 += cone;
    mass.centre_m += 0.75 * cone * offset;  // a cone's centroid is at 3/4 of its height from the tip
  });
  if (mass.area_m2 > 0.0) mass.area_centre_m = origin + mass.area_centre_m / mass.area_m2;
  if (mass.volume_m3 != 0.0) mass.centre_m = origin + mass.centre_m / mass.volume_m3;
  return mass;
}

ShellMass compute_shell_mass(const Surface& surface, double thickness_m, const TrimmedArea& area) {
  SPOONBILL_ASSERT(thickness_m > 0.0);
  const Vector3 origin = surface.net.point(0, 0);
  const double t = thickness_m;
  ShellMass mass;
  visit_area(surface, area, [&](const SurfacePoint& point, double weight) {
    const auto curvatures = compute_principal_curvatures(point);
    if (!curvatures) return;
    const Vector3 normal = point.du.cross(point.dv);
    const double size = weight * normal.norm();
    const double mean = 0.5 * (curvatures->smallest + curvatures->largest);
    const double gaussian = curvatures->smallest * curvatures->largest;
    // Volume of the shell, which is the area of parallel surfaces integrated over the thickness; then the
    // same integral weighted by the depth.
    const double volume = size * t * (1.0 - mean * t + gaussian * t * t / 3.0);
    const double depth = size * t * t * (0.5 - 2.0 / 3.0 * mean * t + 0.25 * gaussian * t * t);
    mass.volume_m3 += volume;
    mass.centre_m += volume * (point.position_m - origin) - depth * normal.normalized();
  });
  if (mass.volume_m3 != 0.0) mass.centre_m = origin + mass.centre_m / mass.volume_m3;
  return mass;
}

namespace {

struct Sums {
  double volume_m3 = 0.0, mass_kg = 0.0;
  Vector3 volume_moment = Vector3::Zero(), mass_moment = Vector3::Zero();
};

Vector3 find_centroid(const CellCorners& corners) {
  return std::accumulate(corners.begin(), corners.end(), Vector3(Vector3::Zero())) / 8.0;
}

}  // namespace

Result<MaterialMix> compute_material_mix(const Body& body) {
  const auto mesh = make_body_lattice(body);
  if (!mesh) return mesh.error();
  const auto materials = lattice_materials(mesh.value(), body.material, body.regions);
  if (!materials) return materials.error();
  Sums sums;
  double own_volume_m3 = 0.0;
  std::set<std::size_t> found;
  for (int k = 0; k + 1 < mesh->count[2]; ++k) {
    for (int i = 0; i + 1 < mesh->count[0]; ++i) {
      for (int j = 0; j + 1 < mesh->count[1]; ++j) {
        const CellCorners corners = mesh->cell(i, j, k);
        const double volume = mesh->cell_fraction(i, j, k) * cell_volume(corners);
        if (!(volume > 0.0)) continue;
        const std::size_t material = materials->index_of(mesh->cell_index(i, j, k));
        const double mass = volume * materials->materials[material].density_kg_per_m3;
        found.insert(material);
        sums.volume_m3 += volume;
        if (material == 0) own_volume_m3 += volume;
        sums.mass_kg += mass;
        sums.volume_moment += volume * find_centroid(corners);
        sums.mass_moment += mass * find_centroid(corners);
      }
    }
  }
  if (!(sums.volume_m3 > 0.0)) return Error{ErrorCode::degenerate, "the lattice of the body has no volume"};
  MaterialMix mix;
  mix.own_fraction = own_volume_m3 / sums.volume_m3;
  mix.own_density_kg_per_m3 = body.material.density_kg_per_m3;
  mix.density_kg_per_m3 = sums.mass_kg / sums.volume_m3;
  mix.mass_offset_m = sums.mass_moment / sums.mass_kg - sums.volume_moment / sums.volume_m3;
  for (const std::size_t material : found) mix.materials.push_back(materials->materials[material].name);
  return mix;
}

BodyMass mass_of_volume(const Body& body, double volume_m3, const Vector3& centre_m) {
  BodyMass mass;
  mass.volume_m3 = volume_m3;
  mass.mix.density_kg_per_m3 = mass.mix.own_density_kg_per_m3 = body.material.density_kg_per_m3;
  mass.mix.materials = {body.material.name};
  const bool is_mixed = std::any_of(body.regions.begin(), body.regions.end(),
                                    [](const MaterialRegion& region) { return region.material.has_value(); });
  if (is_mixed) {
    auto mix = compute_material_mix(body);
    if (mix) mass.mix = std::move(mix).value();
    if (!mix) mass.note = "regions ignored: " + mix.error().message;
  }
  mass.centre_m = centre_m + mass.mix.mass_offset_m;
  return mass;
}

std::optional<BodyMass> compute_body_mass(const Body& body) {
  const auto trim = make_trimmed_area(body);
  if (!trim) return std::nullopt;
  const TrimmedArea area = trim.value() ? *trim.value() : TrimmedArea();
  if (body.shell_thickness_m) {
    const ShellMass shell = compute_shell_mass(body.surface, *body.shell_thickness_m, area);
    return mass_of_volume(body, shell.volume_m3, shell.centre_m);
  }
  if (!area.is_whole() || find_closing(body.surface).closedness != Closedness::solid) return std::nullopt;
  const EnclosedMass mass = compute_enclosed_mass(body.surface);
  return mass_of_volume(body, std::abs(mass.volume_m3), mass.centre_m);
}

}  // namespace spoonbill
