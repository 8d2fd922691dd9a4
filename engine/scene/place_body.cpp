#include "engine/scene/place_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {
namespace {

// Turns or mirrors the directions of loads and motions by the function `turn`.
template <class Turn>
void turn_directions(const Turn& turn, Body& body) {
  for (Load& load : body.loads) {
    if (auto* const force = std::get_if<ForceLoad>(&load)) force->force_n = turn(force->force_n);
    if (auto* const force = std::get_if<PointLoad>(&load)) force->force_n = turn(force->force_n);
  }
  for (Support& support : body.supports) {
    if (support.motion) support.motion->displacement_m = turn(support.motion->displacement_m);
  }
  if (!body.motion) return;
  for (Waypoint& waypoint : body.motion->waypoints) {
    waypoint.moved_m = turn(waypoint.moved_m);
    waypoint.axis = turn(waypoint.axis);
  }
}

// Calls change(region) with every region of the body.
template <class Change>
void for_each_region(Body& body, const Change& change) {
  for (MaterialRegion& region : body.regions) change(region.region);
  for (Load& load : body.loads) {
    if (auto* const pressure = std::get_if<PressureLoad>(&load)) change(pressure->region);
    if (auto* const force = std::get_if<ForceLoad>(&load)) change(force->region);
  }
  for (Support& support : body.supports) change(support.region);
}

// Maps the points of the surface, or the vertices of the mesh where it is.
template <class Map>
void map_points(Body& body, const Map& map) {
  if (!body.mesh) {
    ControlNet& net = body.surface.net;
    for (int i = 0; i < net.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) net.set_point(i, j, map(net.point(i, j)));
    }
    return;
  }
  auto mesh = std::make_shared<CleanMesh>(*body.mesh);
  mesh->mesh = find_placed_mesh(body);
  Box box;
  for (Vector3& vertex_m : mesh->mesh.vertices_m) {
    vertex_m = map(vertex_m);
    box.include(vertex_m);
  }
  mesh->report.size_m = box.extent();
  body.mesh = std::move(mesh);
  body.mesh_pose = {};
}

// Returns the mirrored range of fractions of a turn. Points at the seam and on the axis have the fraction 0,
// as before.
Range<double> reversed_turn(const Range<double>& around) {
  if (around.low == 0.0 && around.high == 1.0) return around;
  constexpr double beyond_seam = 1e-9;
  return {around.high == 1.0 ? beyond_seam : 1.0 - around.high, around.low == 0.0 ? 0.0 : 1.0 - around.low};
}

// Reverses u of a body's surface, which flips its normals, with everything that is given by parameters.
void reverse_u(Body& body) {
  const KnotVector knots = body.surface.u;
  const auto reversed_u = [&](double u) {
    return std::clamp(knots.domain_start() + knots.domain_end() - u, knots.domain_start(),
                      knots.domain_end());
  };
  body.surface = reversed(body.surface, Direction::u);
  for (TrimLoop& loop : body.trims) loop = reversed(loop, Direction::u, knots);
  for (Vector2& corner : body.rim) corner.x() = reversed_u(corner.x());
  for (Load& load : body.loads) {
    if (auto* const point = std::get_if<PointLoad>(&load)) point->u = reversed_u(point->u);
  }
  if (!knots.is_periodic()) return;  // all points of an open sheet have the fraction 0
  for_each_region(body, [](BodyRegion& region) { region.around = reversed_turn(region.around); });
}

void flip_triangles(Body& body) {
  auto mesh = std::make_shared<CleanMesh>(*body.mesh);
  for (TriangleCorners& corners : mesh->mesh.triangles) std::swap(corners[1], corners[2]);
  body.mesh = std::move(mesh);
}

}  // namespace

void move_body(const Pose& pose, Body& body) {
  if (body.mesh) {
    body.mesh_pose = composed(pose, body.mesh_pose);
  } else {
    body.surface = placed(std::move(body.surface), pose);
  }
  turn_directions([&](const Vector3& direction) -> Vector3 { return pose.orientation * direction; }, body);
  if (body.motion) body.motion->point_m = pose.position_m + pose.orientation * body.motion->point_m;
}

void scale_body(const Vector3& factors, const Vector3& fixed_m, Body& body) {
  SPOONBILL_ASSERT(factors.minCoeff() > 0.0);
  const auto scaled = [&](const Vector3& point_m) -> Vector3 {
    return fixed_m + factors.cwiseProduct(point_m - fixed_m);
  };
  map_points(body, scaled);
  const double mean = std::cbrt(factors.prod());
  if (body.shell_thickness_m) *body.shell_thickness_m *= mean;
  for_each_region(body, [&](BodyRegion& region) {
    region.depth_m = {mean * region.depth_m.low, mean * region.depth_m.high};
  });
  if (body.motion) body.motion->point_m = scaled(body.motion->point_m);
}

void mirror_body(const Vector3& point_m, const Vector3& normal, Body& body) {
  SPOONBILL_ASSERT(std::abs(normal.norm() - 1.0) < 1e-9);
  const auto turned = [&](const Vector3& direction) -> Vector3 {
    return direction - 2.0 * normal.dot(direction) * normal;
  };
  const auto mirrored = [&](const Vector3& at_m) -> Vector3 { return point_m + turned(at_m - point_m); };
  map_points(body, mirrored);
  if (body.mesh) {
    flip_triangles(body);
  } else {
    reverse_u(body);
  }
  turn_directions(turned, body);
  if (!body.motion) return;
  body.motion->point_m = mirrored(body.motion->point_m);
  // A mirrored turn goes the other way about the mirrored axis.
  for (Waypoint& waypoint : body.motion->waypoints) waypoint.axis = -waypoint.axis;
}

}  // namespace spoonbill
