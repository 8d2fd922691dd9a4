// Times the computation of control points from a grid of samples, by our code, by the same product with dense
// Eigen matrices, and by OpenCASCADE's approximation. Arguments: samples per side, control points per side.
#include <benchmark/benchmark.h>

#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pnt.hxx>

#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"
#include "tests/bench/agreement.h"
#include "tests/bench/dense_products.h"
#include "tests/bench/sheet.h"

namespace spoonbill {
namespace {

struct Case {
  explicit Case(const benchmark::State& state)
      : sheet(wavy_sheet(static_cast<int>(state.range(1)))),
        grid(sheet_grid(sheet, static_cast<int>(state.range(0)))),
        controls(sheet.net.size()) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < grid.rows() * grid.columns(); ++i)
        samples[axis].push_back(1e-3f * std::sin(0.01f * static_cast<float>(i + axis)));
    }
  }
  Surface sheet;
  Grid grid;
  std::vector<float> samples[3];
  std::vector<float> controls;  // one coordinate of the control points, the one computed last
};

// Returns the rows of samples with the padding that our refit requires.
std::vector<AlignedVector<float>> padded(const Case& which, int stride) {
  std::vector<AlignedVector<float>> all;
  for (const std::vector<float>& samples : which.samples) {
    all.emplace_back(static_cast<std::size_t>(which.grid.rows() * stride), 0.0f);
    for (int i = 0; i < which.grid.rows(); ++i) {
      std::copy_n(&samples[static_cast<std::size_t>(i * which.grid.columns())], which.grid.columns(),
                  &all.back()[static_cast<std::size_t>(i * stride)]);
    }
  }
  return all;
}

// Refits the three coordinates of a displacement, one after another.
template <class Refit, class Samples>
void displace(Refit& refit, const Samples& coordinates, std::vector<float>& controls) {
  for (const auto& samples : coordinates) refit.control_displacement(samples.data(), controls.data());
}

template <class Refit, class Samples>
void time_refit(benchmark::State& state, Refit& refit, const Samples& coordinates,
                std::vector<float>& controls) {
  for (auto _ : state) {
    displace(refit, coordinates, controls);
    benchmark::ClobberMemory();
  }
}

void refit_ours(benchmark::State& state) {
  Case which(state);
  DisplacementRefit refit = DisplacementRefit::make(which.grid, best_instruction_set()).value();
  time_refit(state, refit, padded(which, refit.sample_stride()), which.controls);
}

void refit_dense(benchmark::State& state) {
  Case which(state), ours(state);
  const Eigen::MatrixXd inverse = pseudo_inverse(which.grid.u.knots, which.grid.u.parameters).value();
  std::vector<float> table;
  for (int row = 0; row < inverse.rows(); ++row) {
    for (int column = 0; column < inverse.cols(); ++column)
      table.push_back(static_cast<float>(inverse(row, column)));
  }
  const auto dense =
      make_dense_refit(which.grid.rows(), which.sheet.net.rows, table.data(), best_instruction_set());
  DisplacementRefit refit = DisplacementRefit::make(which.grid, best_instruction_set()).value();
  displace(refit, padded(ours, refit.sample_stride()), ours.controls);
  displace(*dense, which.samples, which.controls);
  // The tolerance is for displacements of a millimetre in single precision, in sums of 200 terms.
  require_agreement(state, largest_difference(ours.controls, which.controls), 1e-7);
  time_refit(state, *dense, which.samples, which.controls);
}

// OpenCASCADE chooses its own parameters and knots, so the number of its control points is only near ours.
void refit_occt(benchmark::State& state) {
  const Case which(state);
  const int side = which.grid.rows();
  TColgp_Array2OfPnt points(1, side, 1, side);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Vector3 point =
          evaluate(which.sheet, which.grid.u.parameters[i], which.grid.v.parameters[j]).position_m;
      points(i + 1, j + 1) = gp_Pnt(point.x(), point.y(), point.z());
    }
  }
  int poles = 0;
  for (auto _ : state) {
    const GeomAPI_PointsToBSplineSurface fit(points, 3, 3, GeomAbs_C2, 1e-3);
    if (!fit.IsDone()) state.SkipWithError("OpenCASCADE found no surface");
    poles = fit.Surface()->NbUPoles();
  }
  state.counters["poles"] = poles;
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond)->Args({50, 8})->Args({200, 8})->Args({200, 32});
}

BENCHMARK(refit_ours)->Apply(sizes);
BENCHMARK(refit_dense)->Apply(sizes);
BENCHMARK(refit_occt)->Unit(benchmark::kMicrosecond)->Args({200, 8});

}  // namespace
}  // namespace spoonbill
