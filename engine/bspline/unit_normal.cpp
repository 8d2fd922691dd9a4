#include "engine/bspline/unit_normal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/bspline/basis.h"

namespace spoonbill {

namespace {

// |du x dv| over the largest that the control points in reach allow. Below, the product is rounding noise of
// the coordinates themselves.
template <class Real>
constexpr double noise = 16.0 * std::numeric_limits<Real>::epsilon();

// In domain lengths. An edge counts as collapsed where the product grows beyond its own size within this
// distance: a ring of control points that a refit in single precision has moved together coincides to about
// 1e-7 only, and the normal of the tiny hole would point anywhere.
constexpr double hole = 1e-6;

// In domain lengths: where a neighbour stands in for a sample whose first-order limit vanishes too.
constexpr double steps_inside[] = {0x1p-14, 0x1p-10, 0x1p-6};

// Derivatives by parameters that run over a domain of length 1, and the bound that they are compared with.
struct LimitTangents {
  Vector3 du = Vector3::Zero(), dv = Vector3::Zero();
  Vector3 duu = Vector3::Zero(), duv = Vector3::Zero(), dvv = Vector3::Zero();
  double product_bound = 0.0;
};

double absolute_sum(const BasisFunctions& basis, int degree, double length) {
  double sum = 0.0;
  for (int j = 0; j <= degree; ++j) sum += std::abs(basis.values[1][j]);
  return sum * length;
}

double length_of(const KnotVector& knots) {
  return knots.domain_end() - knots.domain_start();
}

template <class Real>
LimitTangents tangents_at(const KnotVector& u_knots, const KnotVector& v_knots, const NetView<Real>& net,
                          double u, double v) {
  const BasisFunctions bu = basis_functions(u_knots, u), bv = basis_functions(v_knots, v);
  const auto control = [&](int i, int j) {
    const int index = u_knots.control_index(bu.span, i) * net.columns + v_knots.control_index(bv.span, j);
    return Vector3(net.x[index], net.y[index], net.z[index]);
  };
  // Relative to one control point, so that a distant origin adds no rounding noise.
  const Vector3 origin = control(0, 0);
  LimitTangents tangents;
  double reach = 0.0;
  for (int i = 0; i <= u_knots.degree(); ++i) {
    Vector3 value = Vector3::Zero(), dv = Vector3::Zero(), dvv = Vector3::Zero();
    for (int j = 0; j <= v_knots.degree(); ++j) {
      const Vector3 offset = control(i, j) - origin;
      reach = std::max(reach, offset.norm());
      value += bv.values[0][j] * offset;
      dv += bv.values[1][j] * offset;
      dvv += bv.values[2][j] * offset;
    }
    tangents.du += bu.values[1][i] * value;
    tangents.duu += bu.values[2][i] * value;
    tangents.dv += bu.values[0][i] * dv;
    tangents.duv += bu.values[1][i] * dv;
    tangents.dvv += bu.values[0][i] * dvv;
  }
  const double u_length = length_of(u_knots), v_length = length_of(v_knots);
  tangents.du *= u_length;
  tangents.dv *= v_length;
  tangents.duu *= u_length * u_length;
  tangents.duv *= u_length * v_length;
  tangents.dvv *= v_length * v_length;
  tangents.product_bound = reach * reach * absolute_sum(bu, u_knots.degree(), u_length) *
                           absolute_sum(bv, v_knots.degree(), v_length);
  return tangents;
}

Vector3 direction_of(const Vector3& product) {
  return product / product.norm();
}

bool exceeds(const Vector3& product, double threshold) {
  const double length = product.norm();
  return length > threshold && std::isfinite(length);
}

// +1 where the surface lies toward greater parameters, -1 toward smaller ones, 0 away from an edge.
int inward(const KnotVector& knots, double u) {
  if (knots.is_periodic()) return 0;
  return u <= knots.domain_start() ? 1 : u >= knots.domain_end() ? -1 : 0;
}

// The growth of du x dv per domain length, away from the edge into the surface; zero away from edges.
struct Growth {
  Vector3 by_u = Vector3::Zero(), by_v = Vector3::Zero();
};

Growth growth_from_edge(const LimitTangents& t, int inward_u, int inward_v) {
  return {inward_u * (t.duu.cross(t.dv) + t.du.cross(t.duv)),
          inward_v * (t.duv.cross(t.dv) + t.du.cross(t.dvv))};
}

// A step toward the middle of the domain, so that it never leaves it.
double step_from(const KnotVector& knots, double u, double step) {
  const double length = length_of(knots);
  return u + (u - knots.domain_start() < 0.5 * length ? step : -step) * length;
}

}  // namespace

template <class Real>
Vector3 unit_normal(const KnotVector& u_knots, const KnotVector& v_knots, const NetView<Real>& net, double u,
                    double v) {
  u = u_knots.into_domain(u);
  v = v_knots.into_domain(v);
  const LimitTangents here = tangents_at(u_knots, v_knots, net, u, v);
  const Vector3 product = here.du.cross(here.dv);
  const Growth growth = growth_from_edge(here, inward(u_knots, u), inward(v_knots, v));
  const double threshold = noise<Real> * here.product_bound;
  if (exceeds(product, std::max({threshold, hole * growth.by_u.norm(), hole * growth.by_v.norm()}))) {
    return direction_of(product);
  }
  if (exceeds(growth.by_v, threshold)) return direction_of(growth.by_v);
  if (exceeds(growth.by_u, threshold)) return direction_of(growth.by_u);

  for (const double step : steps_inside) {
    const double u_inside = step_from(u_knots, u, step), v_inside = step_from(v_knots, v, step);
    const double neighbours[][2] = {{u, v_inside}, {u_inside, v}, {u_inside, v_inside}};
    for (const auto& [nu, nv] : neighbours) {
      const LimitTangents there = tangents_at(u_knots, v_knots, net, nu, nv);
      const Vector3 product_there = there.du.cross(there.dv);
      if (exceeds(product_there, noise<Real> * there.product_bound)) return direction_of(product_there);
    }
  }
  return Vector3::Zero();
}

template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<float>&, double, double);
template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<double>&, double, double);

}  // namespace spoonbill
