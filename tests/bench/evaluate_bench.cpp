// Times the evaluation of points and unit normals of a bicubic sheet on a whole grid, by our code, SISL,
// OpenCASCADE and dense Eigen matrices. Arguments: samples per side, control points per side.
#include <benchmark/benchmark.h>
#include <sisl.h>

#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>

#include "engine/bspline/evaluate.h"
#include "tests/bench/agreement.h"
#include "tests/bench/dense_products.h"
#include "tests/bench/opencascade_sheet.h"
#include "tests/bench/sheet.h"

namespace spoonbill {
namespace {

// The tolerances are for single precision on a sheet of 1 m; normals amplify the rounding of the tangents.
constexpr double point_tolerance_m = 2e-5, normal_tolerance = 2e-3;

std::size_t sample_count(const benchmark::State& state) {
  return static_cast<std::size_t>(state.range(0)) * static_cast<std::size_t>(state.range(0));
}

template <class Real>
struct Ours {
  explicit Ours(const benchmark::State& state)
      : sheet(wavy_sheet(static_cast<int>(state.range(1)))),
        grid(sheet_grid(sheet, static_cast<int>(state.range(0)))),
        evaluator(grid, best_instruction_set()),
        x(sheet.net.x.begin(), sheet.net.x.end()),
        y(sheet.net.y.begin(), sheet.net.y.end()),
        z(sheet.net.z.begin(), sheet.net.z.end()) {
    samples.resize(sample_count(state));
  }
  void run() { evaluator.points_and_normals(x.data(), y.data(), z.data(), samples); }

  Surface sheet;
  Grid grid;
  GridEvaluator<Real> evaluator;
  std::vector<Real> x, y, z;
  GridSamples<Real> samples;
};

// Points and normals computed by another library, with interleaved coordinates.
struct Interleaved {
  std::vector<double> points, normals;
};

void require_same(benchmark::State& state, const Interleaved& theirs) {
  Ours<float> ours(state);
  ours.run();
  Interleaved same;
  for (std::size_t k = 0; k < sample_count(state); ++k) {
    same.points.insert(same.points.end(), {ours.samples.x[k], ours.samples.y[k], ours.samples.z[k]});
    same.normals.insert(same.normals.end(), {ours.samples.nx[k], ours.samples.ny[k], ours.samples.nz[k]});
  }
  require_agreement(state, largest_difference(same.points, theirs.points), point_tolerance_m);
  require_agreement(state, largest_difference(same.normals, theirs.normals), normal_tolerance);
}

template <class Real>
void time_ours(benchmark::State& state) {
  Ours<Real> ours(state);
  for (auto _ : state) {
    ours.run();
    benchmark::ClobberMemory();
  }
}

void evaluate_ours(benchmark::State& state) {
  time_ours<float>(state);
}
void evaluate_ours_double(benchmark::State& state) {
  time_ours<double>(state);
}

void evaluate_eigen(benchmark::State& state) {
  Ours<float> ours(state);
  const auto values = dense_table(ours.grid.u.values),
             derivatives = dense_table(ours.grid.u.first_derivatives);
  const DenseSheet tables{ours.grid.rows(), ours.sheet.net.rows, values.data(), derivatives.data()};
  const auto dense = make_dense_evaluation(tables, best_instruction_set());
  const float* const in[3] = {ours.x.data(), ours.y.data(), ours.z.data()};
  GridSamples<float> samples;
  samples.resize(sample_count(state));
  float* const out[6] = {samples.x.data(),  samples.y.data(),  samples.z.data(),
                         samples.nx.data(), samples.ny.data(), samples.nz.data()};
  dense->points_and_normals(in, out);
  ours.run();
  require_agreement(state, largest_difference(ours.samples.y, samples.y), point_tolerance_m);
  require_agreement(state, largest_difference(ours.samples.nx, samples.nx), normal_tolerance);
  for (auto _ : state) {
    dense->points_and_normals(in, out);
    benchmark::ClobberMemory();
  }
}

// A surface for SISL's grid evaluation, s1506, in which the first parameter varies fastest.
struct Sisl {
  explicit Sisl(const Surface& sheet) : knots(sheet.u.knots()) {
    const int side = sheet.net.rows, order = sheet.u.degree() + 1;
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const Vector3 point = sheet.net.point(j, i);
        coefficients.insert(coefficients.end(), {point.x(), point.y(), point.z()});
      }
    }
    surface = newSurf(side, side, order, order, knots.data(), knots.data(), coefficients.data(), 1, 3, 1);
  }
  Sisl(const Sisl&) = delete;
  Sisl& operator=(const Sisl&) = delete;
  ~Sisl() { freeSurf(surface); }

  std::vector<double> knots, coefficients;
  SISLSurf* surface = nullptr;
};

void evaluate_sisl(benchmark::State& state) {
  const Surface sheet = wavy_sheet(static_cast<int>(state.range(1)));
  const int side = static_cast<int>(state.range(0));
  Sisl sisl(sheet);
  std::vector<double> parameters = uniform_parameters(sheet.u, side);
  // Each sample has a point and both tangents.
  constexpr std::size_t stride = 9;
  std::vector<double> derivatives(stride * sample_count(state)), normals(3 * sample_count(state));
  int status = 0;
  const auto run = [&] {
    s1506(sisl.surface, 1, side, parameters.data(), side, parameters.data(), derivatives.data(),
          normals.data(), &status);
  };
  run();
  // SISL's normal is du x dv with the directions exchanged, so it points the opposite way.
  Interleaved theirs{{}, normals};
  for (std::size_t k = 0; k < sample_count(state); ++k)
    theirs.points.insert(theirs.points.end(), &derivatives[stride * k], &derivatives[stride * k] + 3);
  for (double& n : theirs.normals) n = -n;
  require_same(state, theirs);
  for (auto _ : state) {
    run();
    benchmark::ClobberMemory();
  }
}

// Fills the points and normals of `out` in row-major order. `surface` is of any OpenCASCADE class that has
// the function D1().
template <class Evaluable>
void evaluate_with_d1(const Evaluable& surface, const std::vector<double>& parameters, Interleaved& out) {
  std::size_t k = 0;
  for (const double u : parameters) {
    for (const double v : parameters) {
      gp_Pnt point;
      gp_Vec du, dv;
      surface.D1(u, v, point, du, dv);
      const gp_Vec normal = du.Crossed(dv).Normalized();
      for (int axis = 1; axis <= 3; ++axis, ++k) {
        out.points[k] = point.Coord(axis);
        out.normals[k] = normal.Coord(axis);
      }
    }
  }
}

template <class Evaluable>
void time_d1(benchmark::State& state, const Surface& sheet, const Evaluable& surface) {
  const std::vector<double> parameters = uniform_parameters(sheet.u, static_cast<int>(state.range(0)));
  Interleaved out{std::vector<double>(3 * sample_count(state)), std::vector<double>(3 * sample_count(state))};
  evaluate_with_d1(surface, parameters, out);
  require_same(state, out);
  for (auto _ : state) {
    evaluate_with_d1(surface, parameters, out);
    benchmark::ClobberMemory();
  }
}

void evaluate_occt(benchmark::State& state) {
  const Surface sheet = wavy_sheet(static_cast<int>(state.range(1)));
  time_d1(state, sheet, *opencascade_sheet(sheet));
}

// The adaptor caches the polynomial piece of the last point; a row visits each piece only once.
void evaluate_occt_cached(benchmark::State& state) {
  const Surface sheet = wavy_sheet(static_cast<int>(state.range(1)));
  time_d1(state, sheet, GeomAdaptor_Surface(opencascade_sheet(sheet)));
}

// The first sizes vary the number of samples for one number of control points, and the others vary the number
// of control points for one number of samples.
void sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond);
  for (const int samples : {25, 50, 100, 200, 400, 1000}) bench->Args({samples, 8});
  for (const int controls : {16, 32, 64}) bench->Args({200, controls});
}

BENCHMARK(evaluate_ours)->Apply(sizes);
BENCHMARK(evaluate_ours_double)->Apply(sizes);
BENCHMARK(evaluate_eigen)->Apply(sizes);
BENCHMARK(evaluate_sisl)->Apply(sizes);
BENCHMARK(evaluate_occt)->Apply(sizes);
BENCHMARK(evaluate_occt_cached)->Apply(sizes);

}  // namespace
}  // namespace spoonbill
