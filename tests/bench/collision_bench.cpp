// Times the contact of a sphere with a sheet that deforms between queries. Our code uses the exact surface,
// and FCL uses a mesh of 200 x 200 quads without knowledge of the grid. Every query receives the deformed
// shape: control points (with or without samples) for our code, vertices for FCL. Also times the contact of a
// sphere with the handle, for our code only.
#include <benchmark/benchmark.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include "engine/collision/solids/surface_collider.h"
#include "engine/exchange/document.h"
#include "tests/bench/fcl_sheet.h"
#include "tests/bench/sheet.h"

namespace spoonbill {
namespace {

constexpr int controls = 28, levels = 3;  // 25 elements per side, 2^3 cells per side of an element
constexpr std::size_t quads = 200;
constexpr double radius_m = 0.05, depth_m = 0.004;

// Two shapes of one sheet, and the position of a sphere that touches both.
struct Sheets {
  Sheets()
      : nested(make_nested_grid(wavy_sheet(controls).u, wavy_sheet(controls).v, levels).value()),
        shapes{wavy_sheet(controls), wavy_sheet(controls)} {
    for (double& y : shapes[1].net.y) y *= 1.01;
    for (int k = 0; k < 2; ++k) samples[k] = samples_of(shapes[k], nested.grid);
    const SurfacePoint at = evaluate(shapes[0], 0.42, 0.57);
    centre = at.position_m + (radius_m - depth_m) * at.dv.cross(at.du).normalized();
  }
  NestedGrid nested;
  Surface shapes[2];
  GridSamples<double> samples[2];
  Vector3 centre;
};

using FclBox = fcl::AABB<float>;
using FclTurnedBox = fcl::OBBRSS<float>;

template <class Volume>
fcl::CollisionResult<float> contacts_of(const fcl::BVHModel<Volume>& mesh, const Vector3& centre) {
  const fcl::Sphere<float> sphere(static_cast<float>(radius_m));
  fcl::Transform3<float> place = fcl::Transform3<float>::Identity();
  place.translation() = centre.cast<float>();
  fcl::CollisionResult<float> result;
  fcl::collide<float>(&mesh, fcl::Transform3<float>::Identity(), &sphere, place,
                      fcl::CollisionRequest<float>(100000, true), result);
  return result;
}

// Returns true if the contacts of FCL's triangles are in our contact regions.
bool holds(const std::vector<ToolContactRegion>& regions, const Grid& grid,
           const fcl::CollisionResult<float>& result) {
  for (std::size_t k = 0; k < result.numContacts(); ++k) {
    const std::size_t quad = static_cast<std::size_t>(result.getContact(k).b1) / 2;
    const double u = grid.u.parameters[quad / quads], v = grid.v.parameters[quad % quads];
    bool held = false;
    for (const ToolContactRegion& region : regions) {
      const ParameterRange& range = region.range;
      held = held || (range.u0 <= u && u < range.u1 && range.v0 <= v && v < range.v1);
    }
    if (!held) return false;
  }
  return true;
}

// If `given`, the query receives samples as well as control points.
void sphere_ours(benchmark::State& state, bool given) {
  const Sheets sheets;
  SurfaceCollider collider(sheets.nested);
  const ToolShape sphere = ToolShape::sphere(sheets.centre, radius_m);
  std::size_t turn = 0;
  CollisionResult result;
  const auto collide = [&](std::size_t k) {
    const GridSamples<double>& samples = sheets.samples[k];
    const PlanarPoints known{samples.x.data(), samples.y.data(), samples.z.data()};
    return collider.collide(sheets.shapes[k], sphere, 0.0, false, given ? known : PlanarPoints{});
  };
  for (auto _ : state) result = collide(turn++ % 2);
  if (!result.found || result.overflow) state.SkipWithError("the sphere was not found");
  state.counters["contacts"] = static_cast<double>(collider.near_samples().size());
  for (std::size_t k = 0; k < 2; ++k) {
    collide(k);
    const auto theirs =
        contacts_of(*fcl_mesh<FclTurnedBox>(fcl_points(sheets.samples[k]), quads), sheets.centre);
    if (theirs.numContacts() == 0 ||
        !holds(collider.find_contact_regions(sphere), sheets.nested.grid, theirs)) {
      state.SkipWithError("a contact of FCL's is missing");
    }
  }
}

template <class Volume>
void sphere_fcl(benchmark::State& state) {
  keep_freed_pages();
  const Sheets sheets;
  const FclPoints shapes[2] = {fcl_points(sheets.samples[0]), fcl_points(sheets.samples[1])};
  const auto mesh = fcl_mesh<Volume>(shapes[0], quads);
  std::size_t turn = 0, contacts = 0;
  for (auto _ : state) {
    refit(*mesh, shapes[turn++ % 2]);
    contacts = contacts_of(*mesh, sheets.centre).numContacts();
  }
  if (contacts == 0) state.SkipWithError("FCL found no contact");
  state.counters["contacts"] = static_cast<double>(contacts);
}

// A sphere as large as the end of a thumb is 1 mm deep in the bundled handle, whose shape changes between
// queries, as it does between ticks.
void handle_sphere(benchmark::State& state) {
  const Result<Document> document = read_document(SPOONBILL_ASSETS "/models/spoon-handle.json");
  if (!document) return state.SkipWithError(document.error().message.c_str());
  const Surface& handle = document.value().scene.bodies.front().surface;
  Surface shapes[2] = {handle, handle};
  for (double& y : shapes[1].net.y) y *= 1.01;
  const NestedGrid nested = make_nested_grid(handle.u, handle.v, 1).value();
  SurfaceCollider collider(nested);
  constexpr double thumb_m = 0.008, pressed_m = 0.001, margin_m = 0.0005;
  const double u = 0.5 * (handle.u.domain_start() + handle.u.domain_end()),
               v = 0.5 * (handle.v.domain_start() + handle.v.domain_end());
  const Vector3 centre = position(handle, u, v) + (thumb_m - pressed_m) * unit_normal(handle, u, v);
  const ToolShape sphere = ToolShape::sphere(centre, thumb_m);
  std::size_t turn = 0;
  CollisionResult result;
  for (auto _ : state) result = collider.collide(shapes[turn++ % 2], sphere, margin_m, true);
  if (!result.found || result.overflow) state.SkipWithError("the sphere was not found");
}

BENCHMARK_CAPTURE(sphere_ours, from_vertices, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(sphere_ours, from_controls, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(sphere_fcl, FclBox)->Name("sphere_fcl_boxes")->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(sphere_fcl, FclTurnedBox)->Name("sphere_fcl_turned_boxes")->Unit(benchmark::kMicrosecond);
BENCHMARK(handle_sphere)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace spoonbill
