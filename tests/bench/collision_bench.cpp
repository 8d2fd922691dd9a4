// A sphere on a sheet that deforms between queries: ours on the true surface, FCL on a mesh of 200 x 200
// quads, which knows nothing of the grid. Both are given the deformed shape: control points to us, vertices
// to FCL (evaluating them is not in its time).
#include <benchmark/benchmark.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include "engine/collision/surface_collider.h"
#include "tests/bench/agreement.h"
#include "tests/bench/sheet.h"

namespace spoonbill {
namespace {

constexpr int controls = 28, levels = 3;  // 25 elements a side, 2^3 cells each
constexpr int quads = 200;
constexpr double radius_m = 0.05, depth_m = 0.004;

// Two shapes of one sheet, and where a sphere sits in both.
struct Sheets {
  Sheets() : shapes{wavy_sheet(controls), wavy_sheet(controls)} {
    for (double& y : shapes[1].net.y) y *= 1.01;
    const SurfacePoint at = evaluate(shapes[0], 0.42, 0.57);
    centre = at.position_m + (radius_m - depth_m) * at.dv.cross(at.du).normalized();
  }
  Surface shapes[2];
  Vector3 centre;
};

void sphere_ours(benchmark::State& state) {
  const Sheets sheets;
  const NestedGrid nested = make_nested_grid(sheets.shapes[0].u, sheets.shapes[0].v, levels).value();
  SurfaceCollider collider(nested);
  const ToolShape sphere = ToolShape::sphere(sheets.centre, radius_m);
  std::size_t turn = 0;
  CollisionResult result;
  for (auto _ : state) result = collider.collide(sheets.shapes[turn++ % 2], sphere, 0.0, false);
  if (!result.found || result.overflow) state.SkipWithError("the sphere was not found");
  state.counters["contacts"] = static_cast<double>(collider.near_samples().size());
}

using Box = fcl::AABB<float>;
using Points = std::vector<fcl::Vector3<float>>;

Points vertices_of(const Surface& sheet) {
  Points vertices;
  for (const double u : uniform_parameters(sheet.u, quads + 1)) {
    for (const double v : uniform_parameters(sheet.v, quads + 1))
      vertices.push_back(evaluate(sheet, u, v).position_m.cast<float>());
  }
  return vertices;
}

std::shared_ptr<fcl::BVHModel<Box>> mesh_of(const Points& vertices) {
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i < quads; ++i) {
    for (std::size_t j = 0; j < quads; ++j) {
      const std::size_t corner = i * (quads + 1) + j;
      triangles.emplace_back(corner, corner + 1, corner + quads + 1);
      triangles.emplace_back(corner + 1, corner + quads + 2, corner + quads + 1);
    }
  }
  auto mesh = std::make_shared<fcl::BVHModel<Box>>();
  mesh->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  mesh->addSubModel(vertices, triangles);
  mesh->endModel();
  return mesh;
}

void sphere_fcl(benchmark::State& state) {
  const Sheets sheets;
  const Points shapes[2] = {vertices_of(sheets.shapes[0]), vertices_of(sheets.shapes[1])};
  const auto mesh = mesh_of(shapes[0]);
  const fcl::Sphere<float> sphere(static_cast<float>(radius_m));
  fcl::Transform3<float> place = fcl::Transform3<float>::Identity();
  place.translation() = sheets.centre.cast<float>();
  const fcl::CollisionRequest<float> request(100000, true);
  std::size_t turn = 0, contacts = 0;
  for (auto _ : state) {
    mesh->beginReplaceModel();
    mesh->replaceSubModel(shapes[turn++ % 2]);
    mesh->endReplaceModel(true, true);
    fcl::CollisionResult<float> result;
    contacts =
        fcl::collide<float>(mesh.get(), fcl::Transform3<float>::Identity(), &sphere, place, request, result);
  }
  if (contacts == 0) state.SkipWithError("FCL found no contact");
  state.counters["contacts"] = static_cast<double>(contacts);
}

BENCHMARK(sphere_ours)->Unit(benchmark::kMicrosecond);
BENCHMARK(sphere_fcl)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace spoonbill
