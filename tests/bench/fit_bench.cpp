// Times the fit of surfaces with 24 x 24 control points: to a scan of 100,000 points without given
// parameters, and to a grid of points with known parameters. The fit to the grid is compared with
// OpenCASCADE's approximation of the same grid.
#include <benchmark/benchmark.h>

#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <cmath>
#include <gp_Pnt.hxx>
#include <numbers>

#include "engine/bspline/grid.h"
#include "engine/fitting/fit_scan.h"

namespace spoonbill {
namespace {

// Returns points spread evenly (golden spiral) over an egg with dents, about 60 mm long.
Scan dented_egg(int count) {
  Scan scan;
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / count, ring = std::sqrt(1.0 - z * z);
    const double turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double swell = 1.0 + 0.05 * std::sin(3.0 * turn) * ring * std::cos(4.0 * z);
    scan.points_m.emplace_back(0.02 * swell * ring * std::cos(turn), 0.02 * swell * ring * std::sin(turn),
                               0.03 * z);
  }
  return scan;
}

void fit_scan_ours(benchmark::State& state) {
  const Scan scan = dented_egg(static_cast<int>(state.range(0)));
  FitRequest request;
  request.settings.control_u = request.settings.control_v = static_cast<int>(state.range(1));
  double p95 = 0.0;
  for (auto _ : state) {
    const auto fit = fit_scan(scan, request);
    if (!fit) return state.SkipWithError(fit.error().message.c_str());
    p95 = fit->bodies.front().errors.data_to_surface.p95_m;
  }
  if (!(p95 < 1e-4)) state.SkipWithError("the fit is worse than 0.1 mm");
  state.counters["p95_mm"] = 1e3 * p95;
}

PointGrid wavy_grid(const KnotVector& u, const KnotVector& v, int side) {
  PointGrid points{uniform_parameters(u, side), uniform_parameters(v, side), {}};
  for (const double a : points.u) {
    for (const double b : points.v) {
      points.points_m.emplace_back(0.1 * a, 0.1 * b, 0.01 * std::sin(5.0 * a) * std::cos(6.0 * b));
    }
  }
  return points;
}

void fit_grid_ours(benchmark::State& state) {
  const auto knots = KnotVector::clamped_uniform(3, static_cast<int>(state.range(1))).value();
  const PointGrid points = wavy_grid(knots, knots, static_cast<int>(state.range(0)));
  for (auto _ : state) {
    const auto surface = fit_grid(knots, knots, points);
    if (!surface) return state.SkipWithError(surface.error().message.c_str());
    benchmark::DoNotOptimize(surface->net.x.data());
  }
}

// OpenCASCADE chooses its own parameters and knots, for a tolerance that our fit meets as well.
void fit_grid_occt(benchmark::State& state) {
  const auto knots = KnotVector::clamped_uniform(3, static_cast<int>(state.range(1))).value();
  const int side = static_cast<int>(state.range(0));
  const PointGrid grid = wavy_grid(knots, knots, side);
  const auto ours = fit_grid(knots, knots, grid);
  if (!ours || !(largest_deviation_m(ours.value(), grid) < 1e-5)) {
    return state.SkipWithError("ours does not keep the tolerance");
  }
  TColgp_Array2OfPnt points(1, side, 1, side);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Vector3& point = grid.points_m[static_cast<std::size_t>(i * side + j)];
      points(i + 1, j + 1) = gp_Pnt(point.x(), point.y(), point.z());
    }
  }
  int poles = 0;
  for (auto _ : state) {
    const GeomAPI_PointsToBSplineSurface fit(points, 3, 3, GeomAbs_C2, 1e-5);
    if (!fit.IsDone()) return state.SkipWithError("OpenCASCADE found no surface");
    poles = fit.Surface()->NbUPoles();
  }
  state.counters["poles"] = poles;
}

BENCHMARK(fit_scan_ours)->Unit(benchmark::kMillisecond)->Args({100000, 24});
BENCHMARK(fit_grid_ours)->Unit(benchmark::kMillisecond)->Args({100, 24});
BENCHMARK(fit_grid_occt)->Unit(benchmark::kMillisecond)->Args({100, 24});

}  // namespace
}  // namespace spoonbill
