// Compares values, derivatives and normals of B-spline surfaces with OpenCASCADE, an independent
// implementation.
#include <gtest/gtest.h>

#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>

#include "engine/bspline/basis.h"
#include "engine/bspline/evaluate.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

struct OcctDirection {
  TColStd_Array1OfReal knots;
  TColStd_Array1OfInteger multiplicities;
  std::vector<int> controls;  // index of our control point for each pole of OpenCASCADE
  bool periodic;
};

// OpenCASCADE evaluates a periodic surface wrongly if a control point affects a sample through two of its
// periodic images. A direction for which this function returns true is passed to OpenCASCADE as an open one,
// with the extended knots and repeated control points.
bool needs_unrolling(const KnotVector& knots) {
  return knots.control_point_count() <= knots.degree();
}

OcctDirection occt_direction(const KnotVector& knots) {
  const bool periodic = knots.is_periodic() && !needs_unrolling(knots);
  const std::vector<double>& all = periodic ? knots.knots() : knots.extended_knots();
  std::vector<double> distinct = all;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  const int count = static_cast<int>(distinct.size());
  OcctDirection result{TColStd_Array1OfReal(1, count), TColStd_Array1OfInteger(1, count), {}, periodic};
  for (int i = 0; i < count; ++i) {
    result.knots(i + 1) = distinct[i];
    result.multiplicities(i + 1) = static_cast<int>(std::count(all.begin(), all.end(), distinct[i]));
  }
  int first = 0, poles = static_cast<int>(all.size()) - knots.degree() - 1;
  if (periodic) {
    // OpenCASCADE stores the seam's multiplicity at both ends. Its first pole (control point) is the first
    // one that affects the first span.
    const int at_seam = result.multiplicities(1) + result.multiplicities(count) - 1;
    result.multiplicities(1) = result.multiplicities(count) = at_seam;
    first = knots.control_index(knots.find_span(knots.domain_start()), 0);
    poles = knots.control_point_count();
  } else if (knots.is_periodic()) {
    first = knots.control_index(knots.degree(), 0);
  }
  for (int i = 0; i < poles; ++i) result.controls.push_back((first + i) % knots.control_point_count());
  return result;
}

opencascade::handle<Geom_BSplineSurface> occt_surface(const Surface& surface) {
  const OcctDirection u = occt_direction(surface.u), v = occt_direction(surface.v);
  TColgp_Array2OfPnt poles(1, static_cast<int>(u.controls.size()), 1, static_cast<int>(v.controls.size()));
  for (std::size_t i = 0; i < u.controls.size(); ++i) {
    for (std::size_t j = 0; j < v.controls.size(); ++j) {
      const Vector3 point = surface.net.point(u.controls[i], v.controls[j]);
      poles(static_cast<int>(i) + 1, static_cast<int>(j) + 1) = gp_Pnt(point.x(), point.y(), point.z());
    }
  }
  return new Geom_BSplineSurface(poles, u.knots, v.knots, u.multiplicities, v.multiplicities,
                                 surface.u.degree(), surface.v.degree(), u.periodic, v.periodic);
}

SurfacePoint occt_point(const Geom_BSplineSurface& surface, double u, double v) {
  gp_Pnt position;
  gp_Vec du, dv, duu, dvv, duv;
  surface.D2(u, v, position, du, dv, duu, dvv, duv);
  const auto vector = [](const gp_Vec& a) { return Vector3(a.X(), a.Y(), a.Z()); };
  return {{position.X(), position.Y(), position.Z()},
          vector(du),
          vector(dv),
          vector(duu),
          vector(duv),
          vector(dvv)};
}

// Returns the sum of the magnitudes of all basis functions' derivatives. The rounding error of a surface's
// derivative is relative to this sum.
double magnitude(const KnotVector& knots, double u, int derivative) {
  const BasisFunctions basis = basis_functions(knots, knots.into_domain(u));
  double sum = 0.0;
  for (int j = 0; j <= knots.degree(); ++j) sum += std::abs(basis.values[derivative][j]);
  return sum;
}

double net_size(const ControlNet& net) {
  double largest = 0.0;
  for (std::size_t k = 0; k < net.size(); ++k) {
    largest = std::max(largest, Vector3(net.x[k], net.y[k], net.z[k]).norm());
  }
  return largest;
}

// Returns the factor by which the relative rounding error of the tangents is multiplied in the unit normal.
double normal_amplification(const Surface& surface, const SurfacePoint& point, double u, double v) {
  const double size = net_size(surface.net);
  const double error =
      size * (magnitude(surface.u, u, 1) * point.dv.norm() + magnitude(surface.v, v, 1) * point.du.norm());
  return error / point.du.cross(point.dv).norm();
}

// Returns true at the end of a period, where we use the derivatives at the period's start and OpenCASCADE
// uses those from the left.
bool has_two_tangents(const KnotVector& knots, double u) {
  return knots.is_periodic() && u == knots.domain_end();
}

// Tolerances: positions are compared relative to the size of the net, derivatives relative to this size times
// the magnitude() of the basis functions, and unit normals absolutely.
constexpr double double_tolerance = 1e-12, single_tolerance = 1e-5;

void expect_same_point(const Surface& surface, const SurfacePoint& expected, double u, double v) {
  const double size = net_size(surface.net);
  const double u0 = 1.0, u1 = magnitude(surface.u, u, 1), u2 = magnitude(surface.u, u, 2);
  const double v0 = 1.0, v1 = magnitude(surface.v, v, 1), v2 = magnitude(surface.v, v, 2);
  const SurfacePoint found = evaluate(surface, u, v);
  const auto near = [&](const Vector3& a, const Vector3& b, double scale) {
    EXPECT_LE((a - b).norm(), double_tolerance * size * scale);
  };
  near(found.position_m, expected.position_m, u0 * v0);
  if (has_two_tangents(surface.u, u) || has_two_tangents(surface.v, v)) return;
  near(found.du, expected.du, u1 * v0);
  near(found.dv, expected.dv, u0 * v1);
  near(found.duu, expected.duu, u2 * v0);
  near(found.duv, expected.duv, u1 * v1);
  near(found.dvv, expected.dvv, u0 * v2);
}

struct Checked {
  int samples = 0, normals = 0;
};

template <class Real>
void expect_same_grid(const Surface& surface, const Grid& grid, const Geom_BSplineSurface& oracle,
                      double tolerance, InstructionSet set, Checked& checked) {
  const double size = net_size(surface.net);
  const std::vector<Real> x(surface.net.x.begin(), surface.net.x.end());
  const std::vector<Real> y(surface.net.y.begin(), surface.net.y.end());
  const std::vector<Real> z(surface.net.z.begin(), surface.net.z.end());
  GridEvaluator<Real> evaluator(grid, set);
  GridSamples<Real> samples;
  samples.resize(static_cast<std::size_t>(grid.rows()) * grid.columns());
  evaluator.points_and_normals(x.data(), y.data(), z.data(), samples);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const int k = i * grid.columns() + j;
      const double u = grid.u.parameters[i], v = grid.v.parameters[j];
      const SurfacePoint expected = occt_point(oracle, u, v);
      const Vector3 position(samples.x[k], samples.y[k], samples.z[k]);
      EXPECT_LE((position - expected.position_m).norm(), tolerance * size);
      ++checked.samples;
      // The normal is ill-defined if the tangents are nearly parallel or short. It is compared only where the
      // rounding error of the tangents is amplified by less than 20.
      if (has_two_tangents(surface.u, u) || has_two_tangents(surface.v, v)) continue;
      if (!(normal_amplification(surface, expected, u, v) < 20.0)) continue;
      ++checked.normals;
      const Vector3 normal(samples.nx[k], samples.ny[k], samples.nz[k]);
      EXPECT_LE((normal - expected.du.cross(expected.dv).normalized()).norm(), tolerance);
    }
  }
}

TEST(OpenCascade, AgreesOnAThousandRandomSurfaces) {
  Random random(27);
  const auto sets = available_instruction_sets();
  Checked checked;
  int periodic = 0;
  for (int repeat = 0; repeat < 1000 && !::testing::Test::HasFailure(); ++repeat) {
    const Surface surface = random_surface(random);
    SCOPED_TRACE("surface " + std::to_string(repeat) + ", degrees " + std::to_string(surface.u.degree()) +
                 " and " + std::to_string(surface.v.degree()) + ", net " + std::to_string(surface.net.rows) +
                 " x " + std::to_string(surface.net.columns));
    periodic += surface.u.is_periodic() || surface.v.is_periodic() ? 1 : 0;
    const auto oracle = occt_surface(surface);
    const int count = random.integer(5, 20);
    std::vector<double> v_parameters = random_parameters(random, surface.v, count);
    std::vector<double> u_parameters = random_parameters(random, surface.u, 5);
    const Grid grid =
        make_grid(surface.u, surface.v, std::move(u_parameters), std::move(v_parameters)).value();
    for (const double u : grid.u.parameters) {
      for (const double v : grid.v.parameters) expect_same_point(surface, occt_point(*oracle, u, v), u, v);
    }
    const InstructionSet set = sets[static_cast<std::size_t>(repeat) % sets.size()];
    expect_same_grid<double>(surface, grid, *oracle, double_tolerance, set, checked);
    expect_same_grid<float>(surface, grid, *oracle, single_tolerance, set, checked);
  }
  EXPECT_GT(periodic, 300);
  EXPECT_GT(checked.normals, checked.samples / 2);
  RecordProperty("samples", checked.samples);
  RecordProperty("normals", checked.normals);
}

}  // namespace
}  // namespace spoonbill
