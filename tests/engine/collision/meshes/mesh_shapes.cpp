#include "tests/engine/collision/meshes/mesh_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

using std::numbers::pi;

std::uint32_t number(int index) {
  return static_cast<std::uint32_t>(index);
}

// Adds both triangles of the square a b c d.
void add_square(TriangleMesh& mesh, int a, int b, int c, int d) {
  mesh.triangles.push_back({number(a), number(b), number(c)});
  mesh.triangles.push_back({number(a), number(c), number(d)});
}

double segment_distance(const Vector3& a, const Vector3& b, const Vector3& point) {
  const Vector3 way = b - a;
  const double share = std::clamp((point - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (a + share * way - point).norm();
}

}  // namespace

TriangleMesh box_of_triangles(const Vector3& low, const Vector3& high) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    mesh.vertices_m.emplace_back((k & 1) != 0 ? high.x() : low.x(), (k & 2) != 0 ? high.y() : low.y(),
                                 (k & 4) != 0 ? high.z() : low.z());
  }
  add_square(mesh, 0, 2, 3, 1);
  add_square(mesh, 4, 5, 7, 6);
  add_square(mesh, 0, 1, 5, 4);
  add_square(mesh, 2, 6, 7, 3);
  add_square(mesh, 0, 4, 6, 2);
  add_square(mesh, 1, 3, 7, 5);
  return mesh;
}

TriangleMesh ball_mesh(int rings, int around, double radius_m, const Vector3& centre_m) {
  TriangleMesh mesh;
  mesh.vertices_m.push_back(centre_m + radius_m * Vector3::UnitY());
  for (int i = 1; i < rings; ++i) {
    const double polar = pi * i / rings;
    for (int j = 0; j < around; ++j) {
      const double turn = 2.0 * pi * j / around;
      mesh.vertices_m.push_back(centre_m + radius_m * Vector3(std::sin(polar) * std::cos(turn),
                                                              std::cos(polar),
                                                              -std::sin(polar) * std::sin(turn)));
    }
  }
  const int last = static_cast<int>(mesh.vertices_m.size());
  mesh.vertices_m.push_back(centre_m - radius_m * Vector3::UnitY());
  const auto at = [&](int i, int j) { return 1 + (i - 1) * around + j % around; };
  for (int j = 0; j < around; ++j) {
    mesh.triangles.push_back({0, number(at(1, j)), number(at(1, j + 1))});
    for (int i = 1; i + 1 < rings; ++i)
      add_square(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    mesh.triangles.push_back({number(at(rings - 1, j)), number(last), number(at(rings - 1, j + 1))});
  }
  return mesh;
}

TriangleMesh torus_mesh(int along, int around, double displacement_m, double tube_m) {
  TriangleMesh mesh;
  for (int i = 0; i < along; ++i) {
    const double turn = 2.0 * pi * i / along;
    for (int j = 0; j < around; ++j) {
      const double roll = 2.0 * pi * j / around;
      const double out = displacement_m + tube_m * std::cos(roll);
      mesh.vertices_m.emplace_back(out * std::cos(turn), tube_m * std::sin(roll), -out * std::sin(turn));
    }
  }
  const auto at = [&](int i, int j) { return i % along * around + j % around; };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) add_square(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return mesh;
}

TriangleMesh sheet_mesh(int side, double height_m) {
  TriangleMesh mesh;
  for (int i = 0; i <= side; ++i) {
    for (int j = 0; j <= side; ++j) {
      const double x = static_cast<double>(i) / side, y = static_cast<double>(j) / side;
      mesh.vertices_m.emplace_back(x, y, height_m * x * y);
    }
  }
  const auto at = [&](int i, int j) { return i * (side + 1) + j; };
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) add_square(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return mesh;
}

TriangleMesh moebius_strip(int along) {
  TriangleMesh mesh;
  for (int i = 0; i < along; ++i) {
    const double turn = 2.0 * pi * i / along;
    for (const double across : {-0.3, 0.3}) {
      const double out = 1.0 + across * std::cos(0.5 * turn);
      mesh.vertices_m.emplace_back(out * std::cos(turn), across * std::sin(0.5 * turn), out * std::sin(turn));
    }
  }
  for (int i = 0; i + 1 < along; ++i) add_square(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  // The last section is joined to the first one with half a twist.
  add_square(mesh, 2 * along - 2, 1, 0, 2 * along - 1);
  return mesh;
}

TriangleMesh crossing_tube(int along, int around) {
  TriangleMesh mesh;
  for (int i = 0; i < along; ++i) {
    const double turn = 2.0 * pi * i / along;
    const Vector3 centre(std::cos(turn), 0.0, std::sin(2.0 * turn));
    const Vector3 ahead = Vector3(-std::sin(turn), 0.0, 2.0 * std::cos(2.0 * turn)).normalized();
    const Vector3 aside = ahead.cross(Vector3::UnitY());
    for (int j = 0; j < around; ++j) {
      const double roll = 2.0 * pi * j / around;
      mesh.vertices_m.push_back(centre + 0.2 * (std::cos(roll) * aside + std::sin(roll) * Vector3::UnitY()));
    }
  }
  const auto at = [&](int i, int j) { return i % along * around + j % around; };
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) add_square(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  }
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  both.vertices_m.insert(both.vertices_m.end(), b.vertices_m.begin(), b.vertices_m.end());
  for (TriangleCorners corners : b.triangles) {
    for (std::uint32_t& corner : corners) corner += static_cast<std::uint32_t>(a.vertices_m.size());
    both.triangles.push_back(corners);
  }
  return both;
}

TriangleMesh turned(TriangleMesh mesh) {
  for (TriangleCorners& corners : mesh.triangles) std::swap(corners[0], corners[1]);
  return mesh;
}

TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh apart;
  for (const TriangleCorners& corners : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices_m.size());
    for (const std::uint32_t corner : corners) apart.vertices_m.push_back(mesh.vertices_m[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

TriangleMesh without(TriangleMesh mesh, int first, int count) {
  mesh.triangles.erase(mesh.triangles.begin() + first, mesh.triangles.begin() + first + count);
  return mesh;
}

CleanMesh cleaned(const TriangleMesh& mesh) {
  auto clean = clean_mesh(mesh, "mesh");
  EXPECT_TRUE(clean) << clean.error().message;
  return std::move(clean).value();
}

double brute_distance(const TriangleMesh& mesh, const Vector3& point) {
  double best = 1e300;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vector3 &a = mesh.vertices_m[i], &b = mesh.vertices_m[j], &c = mesh.vertices_m[k];
    best = std::min(
        {best, segment_distance(a, b, point), segment_distance(b, c, point), segment_distance(c, a, point)});
    Eigen::Matrix<double, 3, 2> sides;
    sides << b - a, c - a;
    const Eigen::Vector2d shares = (sides.transpose() * sides).inverse() * (sides.transpose() * (point - a));
    if (shares.minCoeff() >= 0.0 && shares.sum() <= 1.0) {
      best = std::min(best, (a + sides * shares - point).norm());
    }
  }
  return best;
}

bool brute_inside(const TriangleMesh& mesh, const Vector3& point, Random& random) {
  int votes = 0;
  for (int ray = 0; ray < 3; ++ray) {
    const Vector3 direction = random_point(random, 1.0);
    int leaving = 0;
    for (const auto& [i, j, k] : mesh.triangles) {
      Eigen::Matrix3d columns;
      columns << mesh.vertices_m[j] - mesh.vertices_m[i], mesh.vertices_m[k] - mesh.vertices_m[i], -direction;
      const double determinant = columns.determinant();
      if (determinant == 0.0) continue;
      const Vector3 at = columns.inverse() * (point - mesh.vertices_m[i]);
      if (at.x() < 0.0 || at.y() < 0.0 || at.x() + at.y() > 1.0 || at.z() <= 0.0) continue;
      leaving += determinant < 0.0 ? 1 : -1;
    }
    votes += leaving > 0 ? 1 : -1;
  }
  return votes > 0;
}

Vector3 random_point(Random& random, double extent_m) {
  const double x = random.uniform(-extent_m, extent_m), y = random.uniform(-extent_m, extent_m);
  return {x, y, random.uniform(-extent_m, extent_m)};
}

int random_point_count(int few) {
  return random_cases(few, 50 * few);
}

}  // namespace spoonbill
