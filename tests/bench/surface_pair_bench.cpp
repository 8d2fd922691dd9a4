// Times the contact of two sheets, one of which deforms between queries. Our code uses the exact surfaces,
// and FCL uses meshes of 200 x 200 quads. Also times the contact of two surfaces that cross each other, for
// our code only.
#include <benchmark/benchmark.h>
#include <fcl/narrowphase/collision.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "engine/collision/surfaces/surface_pair_collider.h"
#include "tests/bench/fcl_sheet.h"
#include "tests/bench/sheet.h"

namespace spoonbill {
namespace {

using FclBox = fcl::AABB<float>;
using FclTurnedBox = fcl::OBBRSS<float>;

constexpr int controls = 28, levels = 3;  // 25 elements per side, 2^3 cells per side of an element
constexpr std::size_t quads = 200;
constexpr double depth_m = 0.004;

Surface with_heights(Surface sheet, const std::function<double(double, double, double)>& height) {
  ControlNet& net = sheet.net;
  for (std::size_t k = 0; k < net.size(); ++k) net.y[k] = height(net.x[k], net.y[k], net.z[k]);
  return sheet;
}

// A hilly sheet in two shapes, and a gently waved sheet that the hilltops touch.
struct Sheets {
  Sheets()
      : nested(make_nested_grid(wavy_sheet(controls).u, wavy_sheet(controls).v, levels).value()),
        shapes{wavy_sheet(controls), wavy_sheet(controls)},
        other(with_heights(wavy_sheet(controls), [](double x, double, double z) {
          return 0.098 - depth_m + 0.002 * std::sin(4.0 * x + 3.0 * z);
        })) {
    for (double& y : shapes[1].net.y) y *= 1.01;
    for (int k = 0; k < 2; ++k) samples[k] = samples_of(shapes[k], nested.grid);
    other_samples = samples_of(other, nested.grid);
  }
  NestedGrid nested;
  Surface shapes[2];
  Surface other;
  GridSamples<double> samples[2], other_samples;
};

PlanarPoints view(const GridSamples<double>& samples) {
  return {samples.x.data(), samples.y.data(), samples.z.data()};
}

// Returns true if our code has a contact in the same pair of cells as each contact of FCL's triangles.
bool holds(const SurfacePairCollider& collider, const fcl::CollisionResult<float>& result) {
  std::set<std::array<int, 4>> cells;
  for (const CellPair& pair : collider.cells()) {
    cells.insert({pair.first.i, pair.first.j, pair.second.i, pair.second.j});
  }
  for (std::size_t k = 0; k < result.numContacts(); ++k) {
    constexpr int side = static_cast<int>(quads);
    const int a = static_cast<int>(result.getContact(k).b1) / 2,
              b = static_cast<int>(result.getContact(k).b2) / 2;
    if (cells.count({a / side, a % side, b / side, b % side}) == 0) return false;
  }
  return true;
}

template <class Volume>
fcl::CollisionResult<float> contacts_of(const fcl::BVHModel<Volume>& a, const fcl::BVHModel<Volume>& b) {
  const fcl::Transform3<float> place = fcl::Transform3<float>::Identity();
  fcl::CollisionResult<float> result;
  fcl::collide<float>(&a, place, &b, place, fcl::CollisionRequest<float>(100000, true), result);
  return result;
}

// One sheet moves, the other does not. If `given`, the query receives samples of the moved sheet as well as
// its control points.
void surfaces_ours(benchmark::State& state, bool given) {
  const Sheets sheets;
  SurfacePairCollider collider(sheets.nested, sheets.nested);
  PairQuery query;
  query.second_samples = view(sheets.other_samples);
  collider.collide(sheets.shapes[0], sheets.other, query);
  std::size_t turn = 0;
  PairResult result;
  for (auto _ : state) {
    if (given) query.first_samples = view(sheets.samples[turn % 2]);
    result = collider.collide(sheets.shapes[turn % 2], sheets.other, query);
    ++turn;
  }
  if (!result.touching || result.overflow) state.SkipWithError("the sheets do not touch");
  state.counters["regions"] = static_cast<double>(collider.contacts().size());
  for (int k = 0; k < 2; ++k) {
    if (given) query.first_samples = view(sheets.samples[k]);
    collider.collide(sheets.shapes[k], sheets.other, query);
    const auto theirs = contacts_of(*fcl_mesh<FclTurnedBox>(fcl_points(sheets.samples[k]), quads),
                                    *fcl_mesh<FclTurnedBox>(fcl_points(sheets.other_samples), quads));
    if (theirs.numContacts() == 0 || !holds(collider, theirs))
      state.SkipWithError("a contact of FCL's is missing");
  }
}

template <class Volume>
void surfaces_fcl(benchmark::State& state) {
  keep_freed_pages();
  const Sheets sheets;
  const FclPoints shapes[2] = {fcl_points(sheets.samples[0]), fcl_points(sheets.samples[1])};
  const auto mesh = fcl_mesh<Volume>(shapes[0], quads);
  const auto other = fcl_mesh<Volume>(fcl_points(sheets.other_samples), quads);
  std::size_t turn = 0, contacts = 0;
  for (auto _ : state) {
    refit(*mesh, shapes[turn++ % 2]);
    contacts = contacts_of(*mesh, *other).numContacts();
  }
  if (contacts == 0) state.SkipWithError("FCL found no contact");
  state.counters["contacts"] = static_cast<double>(contacts);
}

// Both surfaces move, and they cross each other from side to side.
void nets_crossing(benchmark::State& state) {
  constexpr int side = 30;
  const auto crossing = [](double amplitude) {
    return with_heights(wavy_sheet(side), [&](double x, double, double z) {
      return 0.5 * (x - 0.5) + amplitude * std::sin(5.0 * x + 4.0 * z);
    });
  };
  const Surface shapes[2] = {wavy_sheet(side), wavy_sheet(side)};
  const Surface others[2] = {crossing(0.05), crossing(0.052)};
  const NestedGrid nested =
      make_nested_grid(shapes[0].u, shapes[0].v, static_cast<int>(state.range(0))).value();
  SurfacePairCollider collider(nested, nested);
  std::size_t turn = 0;
  PairResult result;
  for (auto _ : state) {
    result = collider.collide(shapes[turn % 2], others[turn % 2], {});
    ++turn;
  }
  if (!result.touching || result.overflow) state.SkipWithError("the nets do not cross");
  state.counters["regions"] = static_cast<double>(collider.contacts().size());
}

BENCHMARK_CAPTURE(surfaces_ours, from_vertices, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(surfaces_ours, from_controls, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(surfaces_fcl, FclBox)->Name("surfaces_fcl_boxes")->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(surfaces_fcl, FclTurnedBox)
    ->Name("surfaces_fcl_turned_boxes")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(nets_crossing)->Arg(1)->Arg(2)->Arg(3)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace spoonbill
