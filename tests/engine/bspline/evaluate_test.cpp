#include "engine/bspline/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/engine/allocations.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"

namespace spoonbill {
namespace {

template <class Real>
std::vector<Real> in_precision(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

template <class Real>
GridSamples<Real> samples_of(const Surface& surface, const Grid& grid, InstructionSet set) {
  GridEvaluator<Real> evaluator(grid, set);
  GridSamples<Real> samples;
  samples.resize(static_cast<std::size_t>(grid.rows()) * grid.columns());
  const auto x = in_precision<Real>(surface.net.x), y = in_precision<Real>(surface.net.y),
             z = in_precision<Real>(surface.net.z);
  evaluator.points_and_normals(x.data(), y.data(), z.data(), samples);
  return samples;
}

template <class Real>
Vector3 point_of(const GridSamples<Real>& samples, int k) {
  return {samples.x[k], samples.y[k], samples.z[k]};
}

template <class Real>
Vector3 normal_of(const GridSamples<Real>& samples, int k) {
  return {samples.nx[k], samples.ny[k], samples.nz[k]};
}

Grid random_grid(Random& random, const Surface& surface, int rows, int columns) {
  return make_grid(surface.u, surface.v, random_parameters(random, surface.u, rows),
                   random_parameters(random, surface.v, columns))
      .value();
}

template <class Real>
void expect_same_samples(const GridSamples<Real>& a, const GridSamples<Real>& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.nx, b.nx);
  EXPECT_EQ(a.ny, b.ny);
  EXPECT_EQ(a.nz, b.nz);
}

TEST(GridEvaluator, AgreesWithSinglePoints) {
  Random random(17);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Surface surface = random_surface(random);
    const Grid grid = random_grid(random, surface, random.integer(2, 12), random.integer(2, 60));
    const auto exact = samples_of<double>(surface, grid, best_instruction_set());
    const auto single = samples_of<float>(surface, grid, best_instruction_set());
    for (int i = 0; i < grid.rows(); ++i) {
      for (int j = 0; j < grid.columns(); ++j) {
        const int k = i * grid.columns() + j;
        const Vector3 position = evaluate(surface, grid.u.parameters[i], grid.v.parameters[j]).position_m;
        // The tolerances allow for the rounding of points, which are weighted means of coordinates below
        // 1 m.
        EXPECT_LT((point_of(exact, k) - position).norm(), 1e-14);
        EXPECT_LT((point_of(single, k) - position).norm(), 1e-6);
        const Vector3 normal = unit_normal(surface, grid.u.parameters[i], grid.v.parameters[j]);
        EXPECT_LT((normal_of(exact, k) - normal).norm(), 1e-10);
      }
    }
  }
}

template <class Real>
void expect_same_bits_on_every_set(std::uint64_t seed) {
  Random random(seed);
  for (int columns = 2; columns < 70; ++columns) {
    Surface surface = random_surface(random);
    if (random.integer(0, 2) == 0) surface = ellipsoid_tube(8, 7);
    if (random.integer(0, 1) == 0) surface = transposed(surface);
    const Grid grid = random_grid(random, surface, random.integer(2, 9), columns);
    const auto baseline = samples_of<Real>(surface, grid, InstructionSet::baseline);
    for (const InstructionSet set : available_instruction_sets()) {
      SCOPED_TRACE(std::string(name_of(set)) + ", " + std::to_string(columns) + " columns");
      expect_same_samples(baseline, samples_of<Real>(surface, grid, set));
    }
  }
}

TEST(GridEvaluator, GivesTheSameBitsOnEveryInstructionSet) {
  expect_same_bits_on_every_set<float>(18);
  expect_same_bits_on_every_set<double>(19);
}

TEST(GridEvaluator, PointsAloneAreTheSameBits) {
  Random random(20);
  for (int columns : {2, 15, 16, 17, 48, 61}) {
    const Surface surface = random_surface(random);
    const Grid grid = random_grid(random, surface, 5, columns);
    for (const InstructionSet set : available_instruction_sets()) {
      const auto both = samples_of<double>(surface, grid, set);
      GridEvaluator<double> evaluator(grid, set);
      GridSamples<double> points;
      points.resize(both.x.size());
      evaluator.points(surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), points);
      EXPECT_EQ(points.x, both.x);
      EXPECT_EQ(points.y, both.y);
      EXPECT_EQ(points.z, both.z);
    }
  }
}

// Returns a sheet that is squeezed in x and z by a random factor between 1e-8 and 1. In single precision, du
// x dv may then be rounding noise at some samples and just above the noise at others.
Surface squeezed_sheet(Random& random) {
  Surface surface = random_surface(random);
  const double squeeze = std::pow(10.0, random.uniform(-8.0, 0.0)), away_m = random.uniform(0.0, 2.0);
  for (double& x : surface.net.x) x = squeeze * x + away_m;
  for (double& z : surface.net.z) z *= squeeze;
  return surface;
}

int index_of(const GridDirection& direction, double parameter) {
  const auto found = std::find(direction.parameters.begin(), direction.parameters.end(), parameter);
  return static_cast<int>(found - direction.parameters.begin());
}

std::vector<double> some_of(Random& random, const std::vector<double>& values, int count) {
  std::vector<double> some = values;
  while (static_cast<int>(some.size()) > count) {
    some.erase(some.begin() + random.integer(0, static_cast<int>(some.size()) - 1));
  }
  return some;
}

// Compares a part of a grid with the whole grid. The evaluator tests whole blocks of 16 samples first: if all
// normals are certainly above the rounding noise, single samples need no test. The part has only 14 samples,
// fewer than a block, so each of them is tested on its own. The evaluator also limits the calls of
// unit_normal() for samples that fail the test. The whole grid has only four rows, too few to reach this
// limit.
void expect_same_bits_in_parts(Random& random, const Surface& surface) {
  const Grid grid = random_grid(random, surface, 4, random.integer(7, 60));
  const Grid part = make_grid(surface.u, surface.v, some_of(random, grid.u.parameters, 2),
                              some_of(random, grid.v.parameters, 7))
                        .value();
  for (const InstructionSet set : available_instruction_sets()) {
    const auto whole = samples_of<float>(surface, grid, set), alone = samples_of<float>(surface, part, set);
    for (int k = 0; k < part.rows() * part.columns(); ++k) {
      const int in_whole = index_of(grid.u, part.u.parameters[k / part.columns()]) * grid.columns() +
                           index_of(grid.v, part.v.parameters[k % part.columns()]);
      EXPECT_EQ(point_of(alone, k), point_of(whole, in_whole));
      EXPECT_EQ(normal_of(alone, k), normal_of(whole, in_whole));
    }
  }
}

TEST(GridEvaluator, EveryPartOfAGridHasTheBitsOfTheWhole) {
  Random random(23);
  for (int repeat = 0; repeat < 300; ++repeat) expect_same_bits_in_parts(random, squeezed_sheet(random));
}

// The cross product of du and dv is the same at all samples of a parallelogram. If it is made narrower, all
// normals therefore become rounding noise at the same width.
TEST(GridEvaluator, APartOfANarrowParallelogramHasTheBitsOfTheWhole) {
  Random random(24);
  const KnotVector line = KnotVector::clamped_uniform(1, 2).value();
  for (double width_m = 1e-7; width_m < 1e-3; width_m *= 1.02) {
    ControlNet net(2, 2);
    net.x = {1, 2, 2, 3};
    net.y = {0, width_m, 0, width_m};
    expect_same_bits_in_parts(random, make_surface(line, line, net).value());
  }
}

TEST(GridEvaluator, TheSeamIsTheSameSampleTwice) {
  const Surface tube = ellipsoid_tube(10, 8);
  const Grid grid =
      make_grid(tube.u, tube.v, uniform_parameters(tube.u, 21), uniform_parameters(tube.v, 33)).value();
  const auto samples = samples_of<float>(tube, grid, best_instruction_set());
  for (int j = 0; j < 33; ++j) {
    EXPECT_EQ(point_of(samples, j), point_of(samples, 20 * 33 + j));
    EXPECT_EQ(normal_of(samples, j), normal_of(samples, 20 * 33 + j));
  }
}

// An evaluator that has evaluated another surface before gives the same samples as a new evaluator.
TEST(GridEvaluator, KeepsNothingFromTheSurfaceBefore) {
  Random random(21);
  const Surface tube = ellipsoid_tube(10, 8), sheet = random_surface(random, tube.u, tube.v);
  const Grid grid =
      make_grid(tube.u, tube.v, uniform_parameters(tube.u, 9), uniform_parameters(tube.v, 32)).value();
  GridEvaluator<double> evaluator(grid, best_instruction_set());
  GridSamples<double> samples;
  samples.resize(9 * 32);
  for (const Surface* surface : {&tube, &sheet, &tube}) {
    evaluator.points_and_normals(surface->net.x.data(), surface->net.y.data(), surface->net.z.data(),
                                 samples);
    expect_same_samples(samples, samples_of<double>(*surface, grid, best_instruction_set()));
  }
}

template <class Real>
void expect_pole_normals(const Surface& surface, double tolerance) {
  const bool poles_in_v = surface.u.is_periodic();
  const double sign = poles_in_v ? 1.0 : -1.0;
  for (const int count : {2, 9, 15, 16, 17, 31, 32, 40}) {
    const Grid grid = make_grid(surface.u, surface.v, uniform_parameters(surface.u, count),
                                uniform_parameters(surface.v, count))
                          .value();
    for (const InstructionSet set : available_instruction_sets()) {
      const auto samples = samples_of<Real>(surface, grid, set);
      for (int t = 0; t < count; ++t) {
        const int start = poles_in_v ? t * count : t;
        const int end = poles_in_v ? t * count + count - 1 : (count - 1) * count + t;
        EXPECT_LT((normal_of(samples, start) - Vector3(0, 0, -sign)).norm(), tolerance) << count;
        EXPECT_LT((normal_of(samples, end) - Vector3(0, 0, sign)).norm(), tolerance) << count;
      }
    }
  }
}

TEST(GridEvaluator, PolesHaveTheirLimitNormals) {
  for (const Vector3& centre : {Vector3(0, 0, 0), Vector3(0.3, -0.2, 0.1)}) {
    const Surface tube = ellipsoid_tube(12, 9, centre);
    // The ring of control points beside the pole has half-axes of 6 and 3 mm. Single precision resolves its
    // coordinates, up to 0.3 m, to about 2e-8 m.
    expect_pole_normals<float>(tube, 1e-4);
    expect_pole_normals<float>(transposed(tube), 1e-4);
    expect_pole_normals<double>(tube, 1e-12);
    expect_pole_normals<double>(transposed(tube), 1e-12);
  }
}

TEST(GridEvaluator, PolesThatARefitHasMovedKeepTheirNormals) {
  Random random(22);
  Surface tube = ellipsoid_tube(12, 9);
  for (int i = 0; i < tube.net.rows; ++i) {
    for (const int j : {0, tube.net.columns - 1}) {
      const Vector3 jitter(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      tube.net.set_point(i, j, tube.net.point(i, j) + 2e-9 * jitter);
    }
  }
  expect_pole_normals<float>(tube, 1e-4);
  expect_pole_normals<double>(tube, 1e-5);
}

TEST(GridEvaluator, SamplesBesideAPoleAgreeWithSinglePoints) {
  const Surface tube = ellipsoid_tube(12, 9);
  std::vector<double> v{0.0};
  for (int power = 0; power < 15; ++power) v.push_back(1e-7 * std::pow(3.0, power));
  v.push_back(1.0);
  const Grid grid = make_grid(tube.u, tube.v, uniform_parameters(tube.u, 13), v).value();
  const auto single = samples_of<float>(tube, grid, best_instruction_set());
  const auto exact = samples_of<double>(tube, grid, best_instruction_set());
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const int k = i * grid.columns() + j;
      const Vector3 normal = unit_normal(tube, grid.u.parameters[i], v[j]);
      EXPECT_LT((normal_of(exact, k) - normal).norm(), 1e-7) << "v = " << v[j];
      // In single precision, the ring of samples at v = 1e-7 is hardly larger than the rounding error of its
      // points.
      EXPECT_LT((normal_of(single, k) - normal).norm(), v[j] < 1e-3 ? 0.3 : 1e-3) << "v = " << v[j];
      EXPECT_NEAR(normal_of(single, k).norm(), 1.0, 1e-6);
    }
  }
}

template <class Real>
void expect_no_normals(const ControlNet& net) {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  const Surface surface = make_surface(knots, knots, net).value();
  const Grid grid =
      make_grid(knots, knots, uniform_parameters(knots, 21), uniform_parameters(knots, 21)).value();
  const auto samples = samples_of<Real>(surface, grid, best_instruction_set());
  for (int k = 0; k < 21 * 21; ++k) EXPECT_EQ(normal_of(samples, k), Vector3::Zero());
}

TEST(GridEvaluator, PointsAndLinesHaveNoNormals) {
  ControlNet point(6, 6), line(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      point.set_point(i, j, {0.1, 0.7, -0.3});
      line.set_point(i, j, Vector3(0.1, 0.7, -0.3) + (i * 0.37 + j * 0.11) * Vector3(1, 2, -0.5));
    }
  }
  expect_no_normals<double>(point);
  expect_no_normals<double>(line);
  expect_no_normals<float>(point);
  expect_no_normals<float>(line);
}

// Returns a tube whose surface at v = 1/2 is a single point. The control points of its poles coincide only to
// 1e-9 m, as after a refit.
Surface pinched_tube() {
  Surface tube = ellipsoid_tube(12, 9);
  for (int j = 3; j < 6; ++j) {
    for (int i = 0; i < 12; ++i) tube.net.set_point(i, j, {0, 0, 0.01 * j});
  }
  for (int i = 0; i < 12; i += 2) {
    for (const int j : {0, 8}) tube.net.set_point(i, j, tube.net.point(i, j) + Vector3(1e-9, 0, 0));
  }
  return tube;
}

TEST(GridEvaluator, APinchBetweenPolesHasTheNormalsBesideIt) {
  const Surface tube = pinched_tube();
  const Grid grid =
      make_grid(tube.u, tube.v, uniform_parameters(tube.u, 14), uniform_parameters(tube.v, 25)).value();
  const auto samples = samples_of<double>(tube, grid, best_instruction_set());
  for (int i = 0; i < 14; ++i) {
    const Vector3 normal = normal_of(samples, i * 25 + 12);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
    EXPECT_EQ(normal, unit_normal(tube, grid.u.parameters[i], 0.5));
  }
}

// A surface passes through the control points at an end only if this end is clamped.
TEST(GridEvaluator, CoincidingControlPointsBeyondAnUnclampedEndAreNoPole) {
  Random random(28);
  const auto unclamped = KnotVector::open(3, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}).value();
  for (const int column : {0, 6}) {
    Surface sheet = random_surface(random, unclamped, unclamped);
    for (int i = 1; i < 7; ++i) sheet.net.set_point(i, column, sheet.net.point(0, column));
    for (const Surface& surface : {sheet, transposed(sheet)}) {
      const Grid grid = random_grid(random, surface, 9, 9);
      const auto samples = samples_of<double>(surface, grid, best_instruction_set());
      for (int k = 0; k < 9 * 9; ++k) {
        const Vector3 normal = unit_normal(surface, grid.u.parameters[k / 9], grid.v.parameters[k % 9]);
        EXPECT_LT((normal_of(samples, k) - normal).norm(), 1e-11);
      }
    }
  }
}

// At the poles and at the pinch, the evaluator calls unit_normal(), which must not allocate either.
TEST(GridEvaluator, AllocatesNothingAfterConstruction) {
  const Surface tube = pinched_tube();
  const Grid grid =
      make_grid(tube.u, tube.v, uniform_parameters(tube.u, 25), uniform_parameters(tube.v, 25)).value();
  GridEvaluator<double> evaluator(grid, best_instruction_set());
  GridSamples<double> samples;
  samples.resize(25 * 25);
  const std::size_t before = allocation_count();
  evaluator.points_and_normals(tube.net.x.data(), tube.net.y.data(), tube.net.z.data(), samples);
  evaluator.points(tube.net.x.data(), tube.net.y.data(), tube.net.z.data(), samples);
  evaluate(tube, 0.3, 0.4);
  unit_normal(tube, 0.3, 0.0);
  EXPECT_EQ(allocation_count(), before);
}

TEST(GridEvaluator, OutlivesCoordinatesThatAreNotNumbers) {
  const auto knots = KnotVector::clamped_uniform(3, 6).value();
  const Grid grid =
      make_grid(knots, knots, uniform_parameters(knots, 20), uniform_parameters(knots, 20)).value();
  GridEvaluator<float> evaluator(grid, best_instruction_set());
  GridSamples<float> samples;
  samples.resize(400);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38f}) {
    std::vector<float> x(36, 0.0f);
    x[14] = bad;
    const std::vector<float> y(36, 1.0f);
    evaluator.points_and_normals(x.data(), y.data(), x.data(), samples);
  }
  SUCCEED();
}

}  // namespace
}  // namespace spoonbill
