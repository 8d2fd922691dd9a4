#include "tests/render/sample_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/bspline/surface.h"
#include "engine/simulation/snapshot_stages.h"

namespace spoonbill {
namespace {

constexpr double length_m = 0.100, width_m = 0.012, thickness_m = 0.005;
constexpr double fixed_share = 1.0 / 3.0;
constexpr int section_points = 16, axis_points = 24;

// Returns a point of the section in the (z, y) plane: a rounded rectangle (superellipse).
Eigen::Vector2d section(double turn) {
  const double angle = 2.0 * std::numbers::pi * turn;
  const auto rounded = [](double c) { return std::copysign(std::pow(std::abs(c), 0.55), c); };
  return {0.5 * width_m * rounded(std::cos(angle)), 0.5 * thickness_m * rounded(std::sin(angle))};
}

// Inverts the power by which section() rounds the corners, so that nodes are evenly spaced along the sides.
double unrounded(double x) {
  return std::copysign(std::pow(std::abs(x), 1.0 / 0.55), x);
}

// Bends the first 22 mm beyond the fixed third of the handle into an arc. The rest stays straight.
Vector3 bent(const Vector3& straight, double bend_rad) {
  const double start = length_m * fixed_share, arc = 0.022;
  if (bend_rad == 0.0 || straight.x() <= start) return straight;
  const double radius = arc / bend_rad;
  const double angle = std::min(straight.x() - start, arc) / radius;
  const double rest = std::max(0.0, straight.x() - start - arc);
  const double out = straight.y() + radius;
  return {start + out * std::sin(angle) + rest * std::cos(angle),
          out * std::cos(angle) - radius - rest * std::sin(angle), straight.z()};
}

Surface make_handle(double bend_rad) {
  ControlNet net(section_points, axis_points);
  for (int j = 0; j < axis_points; ++j) {
    // Both ends are poles: the first and the last ring shrink to a point. The rings beside them are smaller
    // than the rest, which makes the tip round.
    const int from_end = std::min(j, axis_points - 1 - j);
    const double size = from_end == 0 ? 0.0 : from_end == 1 ? 0.72 : from_end == 2 ? 1.0 : 1.05;
    const double t = static_cast<double>(j) / (axis_points - 1);
    const double eased = from_end == 1 ? (j == 1 ? 0.0 : 1.0) : t;
    for (int i = 0; i < section_points; ++i) {
      const Eigen::Vector2d p = size * section(static_cast<double>(i) / section_points);
      net.set_point(i, j, bent({length_m * eased, p.y() + 0.5 * thickness_m, p.x()}, bend_rad));
    }
  }
  return {KnotVector::periodic_uniform(3, section_points).value(),
          KnotVector::clamped_uniform(3, axis_points).value(), net};
}

SurfaceSnapshot snapshot_of(const Surface& surface) {
  SurfaceSnapshot snapshot{surface.u, surface.v, 1, {}, {}, {}};
  snapshot.x.assign(surface.net.x.begin(), surface.net.x.end());
  snapshot.y.assign(surface.net.y.begin(), surface.net.y.end());
  snapshot.z.assign(surface.net.z.begin(), surface.net.z.end());
  return snapshot;
}

// Returns lattice nodes. In each section, the outermost nodes of the rectangular grid are on the surface, and
// the inner nodes are between the surface and the axis.
LatticeSnapshot make_lattice(const Surface& surface, const SampleSceneOptions& options) {
  LatticeSnapshot lattice;
  lattice.count[0] = options.through;
  lattice.count[1] = options.across;
  lattice.count[2] = options.along;
  for (int i = 0; i < options.through; ++i) {
    for (int j = 0; j < options.across; ++j) {
      for (int k = 0; k < options.along; ++k) {
        const double a = 2.0 * j / (options.across - 1) - 1.0, b = 2.0 * i / (options.through - 1) - 1.0;
        const double v = 0.02 + 0.96 * k / (options.along - 1);
        const double rim = std::max(std::abs(a), std::abs(b));
        const double turn = std::atan2(unrounded(b), unrounded(a)) / (2.0 * std::numbers::pi);
        const Vector3 shell = evaluate(surface, turn - 2.0 / section_points + 1.0, v).position_m;
        const Vector3 far = evaluate(surface, turn - 2.0 / section_points + 1.5, v).position_m;
        const Vector3 node = 0.5 * (shell + far) + 0.5 * rim * (shell - far);
        lattice.x.push_back(static_cast<float>(node.x()));
        lattice.y.push_back(static_cast<float>(node.y()));
        lattice.z.push_back(static_cast<float>(node.z()));
        lattice.fixed.push_back(k < options.along / 3 ? 1 : 0);
        lattice.touched.push_back(0);
        lattice.on_shell.push_back(rim > 0.999 ? 1 : 0);
        lattice.in_body.push_back(1);
      }
    }
  }
  return lattice;
}

void touch(const ToolSnapshot& tool, LatticeSnapshot& lattice) {
  for (std::size_t i = 0; i < lattice.x.size(); ++i) {
    const Vector3 node(lattice.x[i], lattice.y[i], lattice.z[i]);
    const bool near = (node - tool.proxy.position_m).norm() < tool.radius_m + 0.0006;
    lattice.touched[i] = near && lattice.on_shell[i] != 0 ? 1 : 0;
  }
}

}  // namespace

Snapshot sample_scene(const SampleSceneOptions& options) {
  const Surface handle = make_handle(options.bend_rad);
  Snapshot snapshot;
  snapshot.bodies.push_back({snapshot_of(handle), make_lattice(handle, options), {}});
  BodySnapshot& body = snapshot.bodies.back();
  body.material.name = options.material;

  const Vector3 touched = bent({0.088, thickness_m, 0.0}, options.bend_rad);
  const Vector3 normal(std::sin(options.bend_rad), std::cos(options.bend_rad), 0.0);
  snapshot.tool.kind = ToolKind::sphere;
  snapshot.tool.radius_m = 0.008;
  snapshot.tool.proxy.position_m = touched + 0.0079 * normal;
  snapshot.tool.device = snapshot.tool.proxy;
  ContactSnapshot contact;
  contact.point_m = touched;
  contact.normal = normal;
  contact.depth_m = 0.0002;
  contact.u = 0.25;
  contact.v = 0.88;
  snapshot.contacts.push_back(contact);
  snapshot.force_n = 1.84 * normal;
  touch(snapshot.tool, body.lattice);

  snapshot.planes.push_back({Vector3(length_m * fixed_share, 0.5 * thickness_m, 0.0), Vector3::UnitX()});
  return snapshot;
}

std::shared_ptr<const ContactStages> sample_stages(const Snapshot& snapshot) {
  return std::make_shared<const ContactStages>(SnapshotStages().find(snapshot));
}

}  // namespace spoonbill
