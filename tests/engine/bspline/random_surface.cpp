#include "tests/engine/bspline/random_surface.h"

#include <algorithm>
#include <utility>

namespace spoonbill {

KnotVector random_knots(Random& random, int degree, KnotKind kind) {
  const int spans = random.integer(1, 6);
  double knot = random.uniform(-1.0, 1.0);
  const auto multiplicity = [&] { return random.integer(0, 2) == 0 ? random.integer(1, degree) : 1; };
  const int before = kind == KnotKind::clamped ? degree + 1 : kind == KnotKind::periodic ? multiplicity() : 1;
  std::vector<double> knots(static_cast<std::size_t>(before), knot);
  const auto step = [&](int times) {
    knot += random.uniform(0.2, 1.0);
    knots.insert(knots.end(), static_cast<std::size_t>(times), knot);
  };
  if (kind == KnotKind::unclamped) {
    for (int i = 0; i < degree; ++i) step(1);
  }
  for (int i = 1; i < spans; ++i) step(multiplicity());
  if (kind == KnotKind::periodic) {
    step(1);
    if (knots.size() < 3) step(1);
    return KnotVector::periodic(degree, std::move(knots)).value();
  }
  step(kind == KnotKind::clamped ? degree + 1 : 1);
  if (kind == KnotKind::unclamped) {
    for (int i = 0; i < degree; ++i) step(1);
  }
  return KnotVector::open(degree, std::move(knots)).value();
}

KnotVector random_knots(Random& random) {
  const int degree = random.integer(1, max_degree);
  const KnotKind kinds[] = {KnotKind::clamped, KnotKind::unclamped, KnotKind::periodic, KnotKind::periodic};
  return random_knots(random, degree, kinds[random.integer(0, 3)]);
}

Surface random_surface(Random& random, KnotVector u, KnotVector v) {
  ControlNet net(u.control_point_count(), v.control_point_count());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      const double x = (i + random.uniform(-0.3, 0.3)) / net.rows;
      const double z = (j + random.uniform(-0.3, 0.3)) / net.columns;
      net.set_point(i, j, {x - 0.5, random.uniform(-0.25, 0.25), z - 0.5});
    }
  }
  return make_surface(std::move(u), std::move(v), std::move(net)).value();
}

Surface random_surface(Random& random) {
  KnotVector u = random_knots(random);
  KnotVector v = random_knots(random);
  return random_surface(random, std::move(u), std::move(v));
}

std::vector<double> random_parameters(Random& random, const KnotVector& knots, int count) {
  std::vector<double> parameters{knots.domain_start(), knots.domain_end()};
  for (int i = 2; i < count; ++i) {
    parameters.push_back(random.uniform(knots.domain_start(), knots.domain_end()));
  }
  std::sort(parameters.begin(), parameters.end());
  parameters.erase(std::unique(parameters.begin(), parameters.end()), parameters.end());
  return parameters;
}

}  // namespace spoonbill
