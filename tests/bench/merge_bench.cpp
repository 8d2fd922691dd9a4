// Merges two patches of 30 x 30 control points that share an edge into one patch with C2 continuity.
#include <benchmark/benchmark.h>

#include <cmath>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/merge.h"

namespace spoonbill {
namespace {

Surface sheet(int columns) {
  const auto u = KnotVector::clamped_uniform(3, 30).value();
  const auto v = KnotVector::clamped_uniform(3, columns).value();
  PointGrid points{uniform_parameters(u, 90), uniform_parameters(v, 3 * columns), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      points.points_m.emplace_back(0.1 * a, 0.1 * b, 0.01 * std::sin(5.0 * a) * std::cos(6.0 * b));
    }
  }
  return fit_grid(u, v, points).value();
}

void merge_halves(benchmark::State& state, const Surface& whole) {
  const std::vector<Surface> halves{part_of(whole, Direction::v, 0.0, 0.5).value(),
                                    part_of(whole, Direction::v, 0.5, 1.0).value()};
  for (auto _ : state) {
    const auto merged = merge(halves, {});
    if (!merged) return state.SkipWithError(merged.error().message.c_str());
    benchmark::DoNotOptimize(merged->surface.net.x.data());
  }
  state.counters["columns"] = halves[0].net.columns;
}

// 57 columns split at a central knot give two patches of 30 columns.
void merge_30x30(benchmark::State& state) {
  merge_halves(state, sheet(57));
}

BENCHMARK(merge_30x30)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spoonbill
