#include "tests/engine/exchange/cad/cad_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include "engine/bspline/evaluate.h"
#include "engine/exchange/document.h"
#include "engine/merging/merge.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"

namespace spoonbill {
namespace {

// Eight-point Gauss-Legendre quadrature on [-1, 1] (Abramowitz and Stegun 1964, table 25.4); the other four
// points mirror these.
constexpr std::array<std::pair<double, double>, 4> gauss{{{0.1834346424956498, 0.3626837833783620},
                                                          {0.5255324099163290, 0.3137066458778873},
                                                          {0.7966664774136267, 0.2223810344533745},
                                                          {0.9602898564975363, 0.1012285362903763}}};

template <class Visit>
void visit_gauss_points(const KnotVector& knots, const Visit& visit) {
  const std::vector<double> ends = knots.breakpoints();
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double middle = 0.5 * (ends[k] + ends[k + 1]), half = 0.5 * (ends[k + 1] - ends[k]);
    for (const auto& [place, weight] : gauss) {
      visit(middle - half * place, half * weight);
      visit(middle + half * place, half * weight);
    }
  }
}

template <class Integrand>
double integral(const Surface& surface, const Integrand& integrand) {
  double sum = 0.0;
  visit_gauss_points(surface.u, [&](double u, double u_weight) {
    visit_gauss_points(surface.v, [&](double v, double v_weight) {
      sum += u_weight * v_weight * integrand(evaluate(surface, u, v));
    });
  });
  return sum;
}

Surface sheet(Random& random, int u_degree, KnotKind u_kind, int v_degree, KnotKind v_kind) {
  return random_surface(random, random_knots(random, u_degree, u_kind),
                        random_knots(random, v_degree, v_kind));
}

// Returns a ball-like patch with two clamped directions: its v edges are poles, and its u edges form a seam.
Surface seamed_ball() {
  const Surface tube = ellipsoid_tube(8, 9);
  const KnotVector u = KnotVector::clamped_uniform(3, 9).value();
  ControlNet net(9, tube.net.columns);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, tube.net.point(i % 8, j));
  }
  return make_surface(u, tube.v, std::move(net)).value();
}

// Returns the bundled bowl and handle, which have different numbers of control points and different knots,
// joined as by the merge command.
Surface merged_spoon() {
  const std::filesystem::path models = SPOONBILL_ASSETS "/models";
  std::vector<Surface> parts;
  for (const char* name : {"spoon-handle.json", "spoon-bowl.json"}) {
    parts.push_back(read_document(models / name).value().scene.bodies[0].surface);
  }
  return merge(parts, {}).value().surface;
}

}  // namespace

Surface torus_like(double ring_m, double tube_m) {
  constexpr int around = 10, across = 8;
  ControlNet net(around, across);
  for (int i = 0; i < around; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / around;
    for (int j = 0; j < across; ++j) {
      const double tilt = 2.0 * std::numbers::pi * j / across;
      const double radius = ring_m + tube_m * std::cos(tilt);
      net.set_point(i, j, {radius * std::cos(turn), radius * std::sin(turn), tube_m * std::sin(tilt)});
    }
  }
  return make_surface(KnotVector::periodic_uniform(3, around).value(),
                      KnotVector::periodic_uniform(3, across).value(), std::move(net))
      .value();
}

std::vector<KnownSurface> known_surfaces() {
  Random random(61);
  std::vector<KnownSurface> all;
  const auto add = [&](const std::string& name, Surface surface, bool closes) {
    CadSurface part;
    part.name = name;
    part.surface = std::move(surface);
    all.push_back({std::move(part), closes});
  };
  for (int degree = 1; degree <= 5; ++degree) {
    const std::string text = " of degree " + std::to_string(degree);
    add("sheet" + text, sheet(random, degree, KnotKind::clamped, 6 - degree, KnotKind::clamped), false);
    add("unclamped sheet" + text, sheet(random, degree, KnotKind::unclamped, 3, KnotKind::clamped), false);
    add("open ring" + text, sheet(random, degree, KnotKind::periodic, 2, KnotKind::clamped), false);
  }
  add("tube with poles", ellipsoid_tube(9, 12), true);
  add("tube inside out", transposed(ellipsoid_tube(8, 10)), true);
  add("ball with a seam", seamed_ball(), true);
  add("ring", torus_like(0.04, 0.012), true);
  add("spoon", merged_spoon(), true);
  return all;
}

double largest_distance_m(const Surface& a, const Surface& b) {
  double largest = 0.0;
  for (const double u : uniform_parameters(a.u, 61)) {
    for (const double v : uniform_parameters(a.v, 61)) {
      largest = std::max(largest, (position(a, u, v) - position(b, u, v)).norm());
    }
  }
  return largest;
}

double volume_by_quadrature_m3(const Surface& surface) {
  return integral(surface, [](const SurfacePoint& at) { return at.position_m.dot(at.du.cross(at.dv)); }) /
         3.0;
}

double area_by_quadrature_m2(const Surface& surface) {
  return integral(surface, [](const SurfacePoint& at) { return at.du.cross(at.dv).norm(); });
}

}  // namespace spoonbill
