#include "render/tessellation/tool_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "tests/render/sample_scene.h"

namespace spoonbill {
namespace {

struct NamedSolid {
  std::string name;
  ToolSolid solid;
  bool flat = false;  // true if the solid has no volume
};

// Returns an L-shaped solid. It is not convex.
MeshSolid bracket() {
  const std::vector<std::pair<double, double>> outline = {{-2, 0},  {-2, 10}, {-6, 10},
                                                          {-6, -4}, {8, -4},  {8, 0}};
  TriangleMesh mesh;
  for (const double z : {-5.0, 5.0}) {
    for (const auto& [x, y] : outline) mesh.vertices_m.push_back(1e-3 * Vector3(x, y, z));
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, 6 + j});
    mesh.triangles.push_back({i, 6 + j, 6 + i});
    if (i < 1 || i > 4) continue;
    mesh.triangles.push_back({0, j, i});
    mesh.triangles.push_back({6, 6 + i, 6 + j});
  }
  return {clean_mesh(std::move(mesh), "bracket").value()};
}

// Returns a single triangle, which has no inside.
MeshSolid sheet() {
  TriangleMesh mesh;
  mesh.vertices_m = {Vector3(0, 0, 0), Vector3(0.01, 0, 0), Vector3(0, 0.01, 0)};
  mesh.triangles.push_back({0, 1, 2});
  return {clean_mesh(std::move(mesh), "sheet").value()};
}

SurfaceSolid tube() {
  const SurfaceSnapshot from = sample_scene({.bend_rad = 0.5}).bodies[0].surface;
  Surface surface{from.u, from.v, ControlNet(from.u.control_point_count(), from.v.control_point_count())};
  surface.net.x.assign(from.x.begin(), from.x.end());
  surface.net.y.assign(from.y.begin(), from.y.end());
  surface.net.z.assign(from.z.begin(), from.z.end());
  return {surface};
}

std::vector<NamedSolid> implicit_solids() {
  const Vector3 size(0.008, 0.006, 0.010);
  return {{"sphere", ImplicitShape(SphereShape{0.007})},
          {"ellipsoid", ImplicitShape(EllipsoidShape{size})},
          {"cylinder", ImplicitShape(CylinderShape{0.005, 0.008})},
          {"capsule", ImplicitShape(CapsuleShape{0.004, 0.006})},
          {"capsule of no length", ImplicitShape(CapsuleShape{0.004, 0.0})},
          {"box", ImplicitShape(BoxShape{size})},
          {"cone", ImplicitShape(ConeShape{0.007, 0.014})},
          {"torus", ImplicitShape(TorusShape{0.008, 0.003})},
          {"half-space", ImplicitShape(HalfSpaceShape{}), true},
          {"nearly a box", ImplicitShape(SuperquadricShape{size, 0.2, 0.2})},
          {"nearly an octahedron", ImplicitShape(SuperquadricShape{size, 1.8, 1.8})},
          {"square and pointed", ImplicitShape(SuperquadricShape{size, 0.3, 1.6})}};
}

std::vector<NamedSolid> all_solids() {
  auto solids = implicit_solids();
  solids.push_back({"bracket", bracket()});
  solids.push_back({"sheet", sheet(), true});
  solids.push_back({"tube", tube()});
  return solids;
}

ToolMesh mesh_of(const ToolSolid& solid) {
  auto mesh = make_tool_mesh(solid);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return std::move(mesh).value();
}

Vector3 corner(const ToolMesh& mesh, std::size_t index) {
  return mesh.vertices[mesh.indices[index]].position_m.cast<double>();
}

// Counts the directed edges of the mesh. Vertices in the same position count as one, because the vertices
// along an edge of the solid occur twice, and a pole is a row of vertices. In these solids, single precision
// resolves positions to a hundredth of a micrometre.
std::map<std::pair<int, int>, int> directed_tool_edges(const ToolMesh& mesh) {
  std::map<std::tuple<long, long, long>, int> places;
  const auto place_of = [&](std::size_t index) {
    const Vector3 at = corner(mesh, index) / 1e-8;
    return places
        .try_emplace({std::lround(at.x()), std::lround(at.y()), std::lround(at.z())},
                     static_cast<int>(places.size()))
        .first->second;
  };
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const int place[3] = {place_of(t), place_of(t + 1), place_of(t + 2)};
    if (place[0] == place[1] || place[1] == place[2] || place[2] == place[0]) continue;
    for (int i = 0; i < 3; ++i) ++edges[{place[i], place[(i + 1) % 3]}];
  }
  return edges;
}

double volume_m3(const ToolMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    sum += corner(mesh, t).dot(corner(mesh, t + 1).cross(corner(mesh, t + 2))) / 6.0;
  }
  return sum;
}

TEST(ToolMesh, IsClosed) {
  for (const NamedSolid& each : all_solids()) {
    const auto edges = directed_tool_edges(mesh_of(each.solid));
    ASSERT_FALSE(edges.empty()) << each.name;
    for (const auto& [edge, count] : edges) {
      const auto other_way = edges.find({edge.second, edge.first});
      ASSERT_NE(other_way, edges.end()) << each.name << ": a triangle on one side only";
      ASSERT_EQ(other_way->second, count) << each.name;
      if (!each.flat) {
        ASSERT_EQ(count, 1) << each.name;
      }
    }
  }
}

// A polyhedron whose vertices are on a smooth surface encloses slightly less than the surface.
TEST(ToolMesh, EnclosesTheVolumeOfTheShape) {
  const double pi = M_PI;
  const std::vector<std::pair<ImplicitShape, double>> volumes = {
      {SphereShape{0.007}, 4.0 / 3.0 * pi * 0.007 * 0.007 * 0.007},
      {EllipsoidShape{{0.008, 0.006, 0.010}}, 4.0 / 3.0 * pi * 0.008 * 0.006 * 0.010},
      {CylinderShape{0.005, 0.008}, pi * 0.005 * 0.005 * 0.016},
      {CapsuleShape{0.004, 0.006}, pi * 0.004 * 0.004 * (0.012 + 4.0 / 3.0 * 0.004)},
      {BoxShape{{0.008, 0.006, 0.010}}, 8.0 * 0.008 * 0.006 * 0.010},
      {ConeShape{0.007, 0.014}, pi * 0.007 * 0.007 * 0.014 / 3.0},
      {TorusShape{0.008, 0.003}, 2.0 * pi * pi * 0.008 * 0.003 * 0.003}};
  for (const auto& [shape, expected] : volumes) {
    EXPECT_NEAR(volume_m3(mesh_of(shape)) / expected, 1.0, 4e-3) << shape.index();
  }
  EXPECT_NEAR(volume_m3(mesh_of(ToolSolid(bracket()))), 1e-9 * 10.0 * (14.0 * 4.0 + 4.0 * 10.0), 1e-13);
}

TEST(ToolMesh, NormalsAreOutwardAndAgreeWithTheTriangles) {
  for (const NamedSolid& each : all_solids()) {
    const ToolMesh mesh = mesh_of(each.solid);
    if (!each.flat) {
      EXPECT_GT(volume_m3(mesh), 0.0) << each.name << " is inside out";
    }
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
      const Vector3 a = corner(mesh, t);
      const Vector3 face = (corner(mesh, t + 1) - a).cross(corner(mesh, t + 2) - a);
      // Slivers at a pole are skipped: their area is as small as the rounding error of single precision.
      if (face.norm() < 1e-11) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Vector3f normal = mesh.vertices[mesh.indices[t + c]].normal;
        ASSERT_NEAR(normal.norm(), 1.0F, 1e-4F) << each.name;
        ASSERT_GT(normal.cast<double>().dot(face.normalized()), 0.0) << each.name;
      }
    }
  }
}

// The normal is the gradient of the exact distance wherever the gradient exists. A point half a micrometre
// along the normal from a vertex of a smooth shape is therefore at a distance of half a micrometre.
TEST(ToolMesh, NormalsOfSmoothShapesAreThoseOfTheDistance) {
  for (const ImplicitShape& shape : std::vector<ImplicitShape>{
           SphereShape{0.007}, EllipsoidShape{{0.008, 0.006, 0.010}}, CapsuleShape{0.004, 0.006},
           TorusShape{0.008, 0.003}, SuperquadricShape{{0.008, 0.006, 0.010}, 0.7, 1.2}}) {
    const auto distance = make_signed_distance(shape);
    const ToolMesh mesh = mesh_of(shape);
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 7) {
      const Vector3 at = mesh.vertices[i].position_m.cast<double>();
      const Vector3 normal = mesh.vertices[i].normal.cast<double>();
      constexpr double step_m = 5e-7;
      // The bounds allow for positions in single precision, which are off by some nanometres.
      EXPECT_NEAR(distance->at(at).distance_m, 0.0, 5e-9);
      EXPECT_NEAR(distance->at(at + step_m * normal).distance_m, step_m, 1e-8);
    }
  }
}

TEST(ToolMesh, FillsTheBoxOfTheShape) {
  auto solids = implicit_solids();
  solids.push_back({"bracket", bracket()});
  for (const NamedSolid& each : solids) {
    Box extent;
    for (const ToolVertex& vertex : mesh_of(each.solid).vertices) {
      extent.include(vertex.position_m.cast<double>());
    }
    const Box box = bounding_box(each.solid);
    // The vertices are in single precision.
    EXPECT_LT((extent.low - box.low).norm(), 1e-8) << each.name;
    EXPECT_LT((extent.high - box.high).norm(), 1e-8) << each.name;
  }
}

TEST(ToolMesh, OfASurfaceLiesWithinTheBoxOfItsControlPoints) {
  const SurfaceSolid solid = tube();
  const Box box = bounding_box(ToolSolid(solid));
  for (const ToolVertex& vertex : mesh_of(solid).vertices) {
    const Vector3 at = vertex.position_m.cast<double>();
    ASSERT_TRUE((at.array() >= box.low.array() - 1e-8).all());
    ASSERT_TRUE((at.array() <= box.high.array() + 1e-8).all());
  }
}

TEST(ToolMesh, OfASphereWithoutRadiusIsEmpty) {
  EXPECT_TRUE(mesh_of(ImplicitShape(SphereShape{0.0})).indices.empty());
}

// A torus seen from its side has many triangles behind each other.
TEST(FacingOrder, GivesWhatFacesTheEyeFromFarToNear) {
  const ToolMesh mesh = mesh_of(ImplicitShape(TorusShape{0.008, 0.003}));
  const Eigen::Vector3f eye(0.05F, 0.01F, 0.0F);
  FacingOrder order;
  const std::vector<std::uint32_t> indices = order.sort(mesh, eye);
  std::size_t facing = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const Vector3 a = corner(mesh, t);
    const Vector3 face = (corner(mesh, t + 1) - a).cross(corner(mesh, t + 2) - a);
    facing += face.dot(eye.cast<double>() - a) > 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(indices.size()) / 3.0, static_cast<double>(facing), 2.0)
      << "single precision may doubt those seen edge on";
  float last_m = 1.0F;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (std::size_t c = 0; c < 3; ++c) middle += mesh.vertices[indices[t + c]].position_m / 3.0F;
    const float distance_m = (middle - eye).norm();
    // The order may be wrong by a ten-thousandth of the torus's depth.
    EXPECT_LT(distance_m, last_m + 0.022F * 1e-4F);
    last_m = distance_m;
  }
}

TEST(FacingOrder, GivesNothingToAnEyeThatIsNowhere) {
  FacingOrder order;
  const ToolMesh mesh = mesh_of(ImplicitShape(TorusShape{0.008, 0.003}));
  EXPECT_TRUE(order.sort(mesh, Eigen::Vector3f::Constant(std::nanf(""))).empty());
}

}  // namespace
}  // namespace spoonbill
