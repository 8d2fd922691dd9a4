#include "render/tessellation/shape_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "render/overlay/solid_tool.h"

namespace spoonbill {
namespace {

constexpr int around = 96;  // pieces of a circle; a multiple of four, so that its widest points are met
constexpr int quarter = around / 4;

// Sine and cosine of a share of the circle, exact where it crosses an axis.
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
  if (at(a) == at(b) || at(b) == at(c) || at(c) == at(a)) return;  // at a pole
  for (const std::uint32_t corner : {a, b, c}) mesh.indices.push_back(corner);
}

// Joins rows of `around` vertices about y, `rows` of them from `first` on, with the outside on the right of
// the way from row to row where that way goes up.
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

// A point of a profile that is turned about y, with its normal.
struct ProfilePoint {
  double radius, height, out, up;
};

void add_turned(const std::vector<ProfilePoint>& profile, ToolMesh& mesh) {
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

// Position and normal by the angles of Barr (1981), with y for his z.
ToolMesh superquadric(const SuperquadricShape& shape) {
  const Vector3& size = shape.semi_axes_m;
  const double e1 = shape.exponent_along, e2 = shape.exponent_around;
  ToolMesh mesh;
  mesh.convex = true;
  for (int row = -quarter; row <= quarter; ++row) {
    const Turn along = turn(row + around);
    for (int i = 0; i < around; ++i) {
      const Turn about = turn(i);
      const auto place = [&](double by_row, double by_piece) {
        const double radius = signed_power(along.cosine, by_row);
        return Vector3(radius * signed_power(about.cosine, by_piece), signed_power(along.sine, by_row),
                       radius * signed_power(about.sine, by_piece));
      };
      add_vertex(place(e1, e2).cwiseProduct(size), place(2.0 - e1, 2.0 - e2).cwiseQuotient(size), mesh);
    }
  }
  join_rows(0, 2 * quarter + 1, mesh);
  return mesh;
}

void add_face(const Vector3& middle, const Vector3& right, const Vector3& up, ToolMesh& mesh) {
  const Vector3 normal = right.cross(up);
  const std::uint32_t a = add_vertex(middle - right - up, normal, mesh);
  const std::uint32_t b = add_vertex(middle + right - up, normal, mesh);
  const std::uint32_t c = add_vertex(middle + right + up, normal, mesh);
  const std::uint32_t d = add_vertex(middle - right + up, normal, mesh);
  add_triangle(a, b, c, mesh);
  add_triangle(a, c, d, mesh);
}

struct MeshOfShape {
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
    add_turned({{0, -h, 0, -1}, {r, -h, 0, -1}}, mesh);
    add_turned({{r, -h, 1, 0}, {r, h, 1, 0}}, mesh);
    add_turned({{r, h, 0, 1}, {0, h, 0, 1}}, mesh);
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
    add_turned(profile, mesh);
    return mesh;
  }

  ToolMesh operator()(const BoxShape& shape) const {
    ToolMesh mesh;
    mesh.convex = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto along = [&](int of) {
        const int which = of % 3;
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
    add_turned({{0, 0, 0, -1}, {r, 0, 0, -1}}, mesh);
    add_turned({{r, 0, h, r}, {0, h, h, r}}, mesh);
    return mesh;
  }

  ToolMesh operator()(const TorusShape& shape) const {
    std::vector<ProfilePoint> profile;
    for (int row = 0; row <= around; ++row) {
      const auto [out, up] = turn(row);
      profile.push_back({shape.ring_radius_m + shape.tube_radius_m * out, shape.tube_radius_m * up, out, up});
    }
    ToolMesh mesh;
    add_turned(profile, mesh);
    return mesh;
  }

  // Both sides: whoever looks from within it sees where it ends.
  ToolMesh operator()(const HalfSpaceShape& /*shape*/) const {
    constexpr double r = half_space_radius_m;
    ToolMesh mesh;
    mesh.convex = true;
    add_turned({{0, 0, 0, -1}, {r, 0, 0, -1}}, mesh);
    add_turned({{r, 0, 0, 1}, {0, 0, 0, 1}}, mesh);
    return mesh;
  }
};

}  // namespace

ToolMesh make_shape_mesh(const ImplicitShape& shape) {
  return std::visit(MeshOfShape{}, shape);
}

}  // namespace spoonbill
