#include "render/tessellation/tool_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/base/geometry.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

Box centred_box(const Vector3& half) {
  return {-half, half};
}

struct ShapeBox {
  Box operator()(const SphereShape& shape) const { return centred_box(Vector3::Constant(shape.radius_m)); }
  Box operator()(const EllipsoidShape& shape) const { return centred_box(shape.semi_axes_m); }
  Box operator()(const CylinderShape& shape) const {
    return centred_box({shape.radius_m, shape.half_length_m, shape.radius_m});
  }
  Box operator()(const CapsuleShape& shape) const {
    return centred_box({shape.radius_m, shape.half_length_m + shape.radius_m, shape.radius_m});
  }
  Box operator()(const BoxShape& shape) const { return centred_box(shape.half_extents_m); }
  Box operator()(const ConeShape& shape) const {
    return {{-shape.base_radius_m, 0.0, -shape.base_radius_m},
            {shape.base_radius_m, shape.height_m, shape.base_radius_m}};
  }
  Box operator()(const TorusShape& shape) const {
    const double out = shape.ring_radius_m + shape.tube_radius_m;
    return centred_box({out, shape.tube_radius_m, out});
  }
  Box operator()(const HalfSpaceShape& /*shape*/) const {
    return centred_box({half_space_radius_m, 0.0, half_space_radius_m});
  }
  Box operator()(const SuperquadricShape& shape) const { return centred_box(shape.semi_axes_m); }
};

struct SolidBox {
  Box operator()(const ImplicitShape& shape) const { return std::visit(ShapeBox{}, shape); }
  Box operator()(const MeshSolid& solid) const { return box_about(solid.mesh.mesh.vertices_m); }
  Box operator()(const SurfaceSolid& solid) const { return spoonbill::bounding_box(solid.surface.net); }
};

constexpr int around = 96;  // pieces of a circle; a multiple of four, so that its widest points are vertices
constexpr int quarter = around / 4;

// Cosine and sine of the angle at which a piece of the circle starts. They are exact on the axes.
struct Turn {
  double cosine, sine;
};

Turn turn(int piece) {
  const int quarters = ((piece / quarter) % 4 + 4) % 4;
  const double angle = 2.0 * std::numbers::pi * (piece % quarter) / around;
  const double c = std::cos(angle), s = std::sin(angle);
  switch (quarters) {
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    case 3:
      return {s, -c};
    default:
      return {c, s};
  }
}

std::uint32_t add_vertex(const Vector3& position_m, const Vector3& normal, ToolMesh& mesh) {
  mesh.vertices.push_back({position_m.cast<float>(), normal.normalized().cast<float>()});
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, ToolMesh& mesh) {
  const auto at = [&](std::uint32_t i) { return mesh.vertices[i].position_m; };
  if (at(a) == at(b) || at(b) == at(c) || at(c) == at(a)) return;  // the triangle is at a pole
  for (const std::uint32_t corner : {a, b, c}) mesh.indices.push_back(corner);
}

// Joins `rows` rings of `around` vertices about the y axis, starting at vertex `first`. Seen with the axis
// upright and the profile to its right, the outside must be on the right of the path from ring to ring.
void join_rows(std::uint32_t first, int rows, ToolMesh& mesh) {
  for (int row = 0; row + 1 < rows; ++row) {
    for (int i = 0; i < around; ++i) {
      const auto at = [&](int r, int piece) {
        return first + static_cast<std::uint32_t>(r * around + piece % around);
      };
      add_triangle(at(row, i), at(row + 1, i + 1), at(row, i + 1), mesh);
      add_triangle(at(row, i), at(row + 1, i), at(row + 1, i + 1), mesh);
    }
  }
}

// A point of a profile that is revolved about y, with its normal.
struct ProfilePoint {
  double radius, height, out, up;
};

void add_revolved(const std::vector<ProfilePoint>& profile, ToolMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const ProfilePoint& p : profile) {
    for (int i = 0; i < around; ++i) {
      const auto [c, s] = turn(i);
      add_vertex({p.radius * c, p.height, p.radius * s}, {p.out * c, p.up, p.out * s}, mesh);
    }
  }
  join_rows(first, static_cast<int>(profile.size()), mesh);
}

double signed_power(double x, double exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

// Returns a mesh of a superquadric over the two angles of Barr (1981), with Barr's z axis as y.
ToolMesh superquadric(const SuperquadricShape& shape) {
  const Vector3& size = shape.semi_axes_m;
  const double e1 = shape.exponent_along, e2 = shape.exponent_around;
  ToolMesh mesh;
  mesh.convex = true;
  for (int row = -quarter; row <= quarter; ++row) {
    const Turn along = turn(row + around);
    for (int i = 0; i < around; ++i) {
      const Turn about = turn(i);
      const auto point = [&](double by_row, double by_piece) {
        const double radius = signed_power(along.cosine, by_row);
        return Vector3(radius * signed_power(about.cosine, by_piece), signed_power(along.sine, by_row),
                       radius * signed_power(about.sine, by_piece));
      };
      add_vertex(point(e1, e2).cwiseProduct(size), point(2.0 - e1, 2.0 - e2).cwiseQuotient(size), mesh);
    }
  }
  join_rows(0, 2 * quarter + 1, mesh);
  return mesh;
}

void add_face(const Vector3& centre, const Vector3& right, const Vector3& up, ToolMesh& mesh) {
  const Vector3 normal = right.cross(up);
  const std::uint32_t a = add_vertex(centre - right - up, normal, mesh);
  const std::uint32_t b = add_vertex(centre + right - up, normal, mesh);
  const std::uint32_t c = add_vertex(centre + right + up, normal, mesh);
  const std::uint32_t d = add_vertex(centre - right + up, normal, mesh);
  add_triangle(a, b, c, mesh);
  add_triangle(a, c, d, mesh);
}

struct ShapeMesher {
  ToolMesh operator()(const SphereShape& shape) const {
    if (shape.radius_m == 0.0) return {};
    return superquadric({Vector3::Constant(shape.radius_m)});
  }
  ToolMesh operator()(const EllipsoidShape& shape) const { return superquadric({shape.semi_axes_m}); }
  ToolMesh operator()(const SuperquadricShape& shape) const { return superquadric(shape); }

  ToolMesh operator()(const CylinderShape& shape) const {
    const double r = shape.radius_m, h = shape.half_length_m;
    ToolMesh mesh;
    mesh.convex = true;
    add_revolved({{0, -h, 0, -1}, {r, -h, 0, -1}}, mesh);
    add_revolved({{r, -h, 1, 0}, {r, h, 1, 0}}, mesh);
    add_revolved({{r, h, 0, 1}, {0, h, 0, 1}}, mesh);
    return mesh;
  }

  ToolMesh operator()(const CapsuleShape& shape) const {
    const double r = shape.radius_m, h = shape.half_length_m;
    std::vector<ProfilePoint> profile;
    for (int row = -quarter; row <= quarter; ++row) {
      const auto [out, up] = turn(row + around);
      if (row <= 0) profile.push_back({r * out, r * up - h, out, up});
      if (row > 0 || (row == 0 && h > 0.0)) profile.push_back({r * out, r * up + h, out, up});
    }
    ToolMesh mesh;
    mesh.convex = true;
    add_revolved(profile, mesh);
    return mesh;
  }

  ToolMesh operator()(const BoxShape& shape) const {
    ToolMesh mesh;
    mesh.convex = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto along = [&](int index) {
        const int which = index % 3;
        return Vector3(shape.half_extents_m[which] * Vector3::Unit(which));
      };
      add_face(along(axis), along(axis + 1), along(axis + 2), mesh);
      add_face(-along(axis), along(axis + 2), along(axis + 1), mesh);
    }
    return mesh;
  }

  ToolMesh operator()(const ConeShape& shape) const {
    const double r = shape.base_radius_m, h = shape.height_m;
    ToolMesh mesh;
    mesh.convex = true;
    add_revolved({{0, 0, 0, -1}, {r, 0, 0, -1}}, mesh);
    add_revolved({{r, 0, h, r}, {0, h, h, r}}, mesh);
    return mesh;
  }

  ToolMesh operator()(const TorusShape& shape) const {
    std::vector<ProfilePoint> profile;
    for (int row = 0; row <= around; ++row) {
      const auto [out, up] = turn(row);
      profile.push_back({shape.ring_radius_m + shape.tube_radius_m * out, shape.tube_radius_m * up, out, up});
    }
    ToolMesh mesh;
    add_revolved(profile, mesh);
    return mesh;
  }

  // Returns both sides of a disc, so that it is visible from inside the half-space too.
  ToolMesh operator()(const HalfSpaceShape& /*shape*/) const {
    constexpr double r = half_space_radius_m;
    ToolMesh mesh;
    mesh.convex = true;
    add_revolved({{0, 0, 0, -1}, {r, 0, 0, -1}}, mesh);
    add_revolved({{r, 0, 0, 1}, {0, 0, 0, 1}}, mesh);
    return mesh;
  }
};

// Size on the screen, in pixels, for which a surface is tessellated.
constexpr double surface_px = 1500.0;

using Corners = std::array<Eigen::Vector3f, 3>;

void add_flat(const Corners& corners, ToolMesh& mesh) {
  const Eigen::Vector3f across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  // Triangles too thin for single precision are skipped.
  if (!(across.squaredNorm() > 0.0F)) return;
  for (const Eigen::Vector3f& corner : corners) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back({corner, across.normalized()});
  }
}

SurfaceSnapshot make_snapshot(const Surface& surface) {
  SurfaceSnapshot snapshot{surface.u, surface.v, 0, {}, {}, {}};
  snapshot.x.assign(surface.net.x.begin(), surface.net.x.end());
  snapshot.y.assign(surface.net.y.begin(), surface.net.y.end());
  snapshot.z.assign(surface.net.z.begin(), surface.net.z.end());
  return snapshot;
}

struct SolidMesher {
  Result<ToolMesh> operator()(const ImplicitShape& shape) const { return std::visit(ShapeMesher{}, shape); }

  Result<ToolMesh> operator()(const MeshSolid& solid) const {
    const TriangleMesh& triangles = solid.mesh.mesh;
    ToolMesh mesh;
    for (const MeshPart& part : solid.mesh.parts) {
      for (std::uint32_t t = part.first_triangle; t < part.end_triangle; ++t) {
        Corners corners;
        for (std::size_t c = 0; c < 3; ++c) {
          corners[c] = triangles.vertices_m[triangles.triangles[t][c]].cast<float>();
        }
        add_flat(corners, mesh);
        if (!part.closed) add_flat({corners[0], corners[2], corners[1]}, mesh);
      }
    }
    return mesh;
  }

  Result<ToolMesh> operator()(const SurfaceSolid& solid) const {
    const SurfaceSnapshot snapshot = make_snapshot(solid.surface);
    const Box box = bounding_box(ToolSolid(solid));
    const double pixels_per_metre = surface_px / box.size();
    TessellatedSurface surface;
    const Status updated = surface.update(snapshot, choose_sampling_level(snapshot, pixels_per_metre, {}));
    if (!updated) return updated.error().in("tool");
    ToolMesh mesh;
    const GridSamples<float>& at = surface.samples();
    for (std::size_t i = 0; i < surface.vertex_count(); ++i) {
      mesh.vertices.push_back({{at.x[i], at.y[i], at.z[i]}, {at.nx[i], at.ny[i], at.nz[i]}});
    }
    mesh.indices = surface.indices();
    return mesh;
  }
};

constexpr std::uint32_t bucket_count = 1U << 14;

}  // namespace

Result<ToolMesh> make_tool_mesh(const ToolSolid& solid) {
  return std::visit(SolidMesher{}, solid);
}

const ToolBody* rigid_body(const ToolSnapshot& tool) {
  return tool.kind == ToolKind::solid && tool.body && !tool.body->soft ? tool.body.get() : nullptr;
}

bool is_soft(const ToolSnapshot& tool) {
  return tool.kind == ToolKind::solid && tool.body && tool.body->soft;
}

bool is_tool_body(const Snapshot& snapshot, const BodySnapshot& body) {
  return is_soft(snapshot.tool) && !snapshot.bodies.empty() && &body == &snapshot.bodies.back();
}

Box bounding_box(const ToolSolid& solid) {
  return std::visit(SolidBox{}, solid);
}

ToolFrame tool_frame(const Snapshot& snapshot) {
  return {snapshot.tool.proxy.orientation.toRotationMatrix(), snapshot.tool.proxy.position_m};
}

// With the reflection S and the rotation R of the tool, the axes of the mirror image are S R. The mirrored
// pose has the rotation S R S, and (S R S) S is S R.
ToolFrame mirrored_tool_frame(const Snapshot& snapshot) {
  const Vector3& normal = snapshot.symmetry.normal;
  const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
  return {snapshot.mirrored_proxy.orientation.toRotationMatrix() * reflection,
          snapshot.mirrored_proxy.position_m};
}

Vector3 find_exit_point(const Box& box, const ToolFrame& frame, const Vector3& direction) {
  const Vector3 local = frame.axes.transpose() * direction;
  const Vector3 centre = box.centre(), half = 0.5 * box.extent();
  double length = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (local[axis] != 0.0) length = std::min(length, half[axis] / std::abs(local[axis]));
  }
  return frame.origin_m + frame.axes * (centre + length * local);
}

void FacingOrder::find_facing(const ToolMesh& mesh, const Eigen::Vector3f& eye_m) {
  facing_.clear();
  float nearest_m = std::numeric_limits<float>::max();
  farthest_m_ = 0.0F;
  const auto at = [&](std::size_t i) -> const Eigen::Vector3f& {
    return mesh.vertices[mesh.indices[i]].position_m;
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Eigen::Vector3f &a = at(i), &b = at(i + 1), &c = at(i + 2);
    if (!((b - a).cross(c - a).dot(eye_m - a) > 0.0F)) continue;
    const float distance_m = ((a + b + c) / 3.0F - eye_m).norm();
    nearest_m = std::min(nearest_m, distance_m);
    farthest_m_ = std::max(farthest_m_, distance_m);
    facing_.push_back({distance_m, static_cast<std::uint32_t>(i)});
  }
  const float range_m = farthest_m_ - nearest_m;
  buckets_per_m_ = range_m > 0.0F ? static_cast<float>(bucket_count) / range_m : 0.0F;
}

// Returns the bucket of a distance; the farthest distances are in the first bucket. Distances too large for
// single precision are in the first or last bucket.
std::uint32_t FacingOrder::bucket_index(float distance_m) const {
  const float bucket = (farthest_m_ - distance_m) * buckets_per_m_;
  if (!(bucket > 0.0F)) return 0;
  return bucket < static_cast<float>(bucket_count) ? static_cast<std::uint32_t>(bucket) : bucket_count - 1;
}

const std::vector<std::uint32_t>& FacingOrder::sort(const ToolMesh& mesh, const Eigen::Vector3f& eye_m) {
  find_facing(mesh, eye_m);
  ends_.assign(bucket_count, 0);
  for (const Facing& triangle : facing_) ++ends_[bucket_index(triangle.distance_m)];
  for (std::uint32_t b = 1; b < bucket_count; ++b) ends_[b] += ends_[b - 1];
  indices_.resize(3 * facing_.size());
  for (auto triangle = facing_.rbegin(); triangle != facing_.rend(); ++triangle) {
    const std::size_t offset = 3 * static_cast<std::size_t>(--ends_[bucket_index(triangle->distance_m)]);
    std::copy_n(mesh.indices.begin() + triangle->first_index, 3,
                indices_.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  return indices_;
}

}  // namespace spoonbill
