#include "engine/bspline/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/basis.h"

namespace spoonbill {

namespace {

Status check_coordinates(const ControlNet& net, const std::vector<double>& values, char coordinate) {
  if (values.size() != net.size()) {
    return Error{ErrorCode::mismatch, std::string("control points: ") + std::to_string(values.size()) + " " +
                                          coordinate + " coordinates for a net of " +
                                          std::to_string(net.rows) + " x " + std::to_string(net.columns) +
                                          "; give " + std::to_string(net.size())};
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) {
      const std::size_t columns = static_cast<std::size_t>(net.columns);
      return Error{ErrorCode::out_of_range, "control point (" + std::to_string(k / columns) + ", " +
                                                std::to_string(k % columns) + "): " + coordinate + " (" +
                                                number_text(values[k]) +
                                                ") is not a finite number; replace it"};
    }
  }
  return {};
}

struct Interval {
  double low, high;
};

// Returns the range of the values. Four ranges grow in turn, so that no comparison waits for the one before.
Interval find_range(const std::vector<double>& values) {
  constexpr std::size_t lane_count = 4;
  double low[lane_count], high[lane_count];
  std::fill_n(low, lane_count, values[0]);
  std::fill_n(high, lane_count, values[0]);
  const auto include = [&](std::size_t lane, double value) {
    low[lane] = value < low[lane] ? value : low[lane];
    high[lane] = value > high[lane] ? value : high[lane];
  };
  const std::size_t whole = values.size() - values.size() % lane_count;
  for (std::size_t start = 0; start < whole; start += lane_count) {
    for (std::size_t lane = 0; lane < lane_count; ++lane) include(lane, values[start + lane]);
  }
  for (std::size_t k = whole; k < values.size(); ++k) include(0, values[k]);
  return {*std::min_element(low, low + lane_count), *std::max_element(high, high + lane_count)};
}

}  // namespace

Box bounding_box(const ControlNet& net) {
  if (net.size() == 0) return {};
  const Interval x = find_range(net.x), y = find_range(net.y), z = find_range(net.z);
  return {{x.low, y.low, z.low}, {x.high, y.high, z.high}};
}

Result<Surface> make_surface(KnotVector u, KnotVector v, ControlNet net) {
  if (net.rows != u.control_point_count() || net.columns != v.control_point_count()) {
    return Error{ErrorCode::mismatch,
                 "control net of " + std::to_string(net.rows) + " x " + std::to_string(net.columns) +
                     " does not fit the knots, which require " + std::to_string(u.control_point_count()) +
                     " x " + std::to_string(v.control_point_count()) + "; change the net or the knots"};
  }
  if (Status status = check_coordinates(net, net.x, 'x'); !status) return status.error();
  if (Status status = check_coordinates(net, net.y, 'y'); !status) return status.error();
  if (Status status = check_coordinates(net, net.z, 'z'); !status) return status.error();
  return Surface{std::move(u), std::move(v), std::move(net)};
}

bool has_matching_net(const Surface& surface) {
  const ControlNet& net = surface.net;
  return net.rows > 0 && net.rows == surface.u.control_point_count() &&
         net.columns == surface.v.control_point_count() && net.x.size() == net.size() &&
         net.y.size() == net.size() && net.z.size() == net.size();
}

bool is_valid(const Surface& surface) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  return has_matching_net(surface) && std::all_of(surface.net.x.begin(), surface.net.x.end(), is_finite) &&
         std::all_of(surface.net.y.begin(), surface.net.y.end(), is_finite) &&
         std::all_of(surface.net.z.begin(), surface.net.z.end(), is_finite);
}

const KnotVector& knots_along(const Surface& surface, Direction direction) {
  return direction == Direction::u ? surface.u : surface.v;
}

Surface placed(Surface surface, const Pose& pose) {
  SPOONBILL_ASSERT(has_matching_net(surface));
  place(surface.net, pose.orientation.toRotationMatrix(), pose.position_m, surface.net);
  return surface;
}

void place(const ControlNet& net, const Eigen::Matrix3d& turn, const Vector3& position_m,
           ControlNet& placed) {
  SPOONBILL_ASSERT(placed.rows == net.rows && placed.columns == net.columns);
  SPOONBILL_ASSERT(net.z.size() == net.size() && placed.z.size() == net.size());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) {
      placed.set_point(i, j, turn * net.point(i, j) + position_m);
    }
  }
}

SurfacePoint evaluate(const Surface& surface, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(has_matching_net(surface));
  const BasisFunctions bu = basis_functions(surface.u, surface.u.into_domain(u));
  const BasisFunctions bv = basis_functions(surface.v, surface.v.into_domain(v));
  SurfacePoint point{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(),
                     Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  for (int i = 0; i <= surface.u.degree(); ++i) {
    const int row = surface.u.control_index(bu.span, i);
    Vector3 value = Vector3::Zero(), dv = Vector3::Zero(), dvv = Vector3::Zero();
    for (int j = 0; j <= surface.v.degree(); ++j) {
      const Vector3 control = surface.net.point(row, surface.v.control_index(bv.span, j));
      value += bv.values[0][j] * control;
      dv += bv.values[1][j] * control;
      dvv += bv.values[2][j] * control;
    }
    point.position_m += bu.values[0][i] * value;
    point.du += bu.values[1][i] * value;
    point.duu += bu.values[2][i] * value;
    point.dv += bu.values[0][i] * dv;
    point.duv += bu.values[1][i] * dv;
    point.dvv += bu.values[0][i] * dvv;
  }
  return point;
}

Vector3 position(const Surface& surface, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(has_matching_net(surface));
  // basis_values() sets only the span and values[0]; the derivatives are not read here.
  BasisFunctions bu, bv;
  basis_values(surface.u, surface.u.into_domain(u), bu);
  basis_values(surface.v, surface.v.into_domain(v), bv);
  std::array<int, max_degree + 1> columns;
  for (int j = 0; j <= surface.v.degree(); ++j) columns[j] = surface.v.control_index(bv.span, j);
  Vector3 point = Vector3::Zero();
  for (int i = 0; i <= surface.u.degree(); ++i) {
    const int row = surface.u.control_index(bu.span, i);
    Vector3 value = Vector3::Zero();
    for (int j = 0; j <= surface.v.degree(); ++j) {
      value += bv.values[0][j] * surface.net.point(row, columns[j]);
    }
    point += bu.values[0][i] * value;
  }
  return point;
}

Vector3 unit_normal(const Surface& surface, double u, double v) {
  SPOONBILL_ASSERT_DEBUG(has_matching_net(surface));
  return unit_normal(
      surface.u, surface.v,
      NetView<double>{surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), surface.net.columns},
      u, v);
}

namespace {

// Smallest usable ratio of |du x dv| to its upper bound (LimitTangents::product_bound). If the ratio is
// smaller, the product is only rounding noise of the coordinates.
template <class Real>
constexpr double product_noise = 16.0 * std::numeric_limits<Real>::epsilon();

// Distance from an edge, in domain lengths. The edge counts as collapsed if, over this distance, du x dv
// grows by more than its value at the edge. The control points of a collapsed edge need not coincide exactly,
// because after a refit in single precision they coincide only to about 1e-7. The edge is then the border of
// a tiny hole, around which du x dv has an arbitrary direction, also at parameters within this distance.
constexpr double hole = 1e-6;

// Largest part of its growth from a collapsed edge by which du x dv may differ from it beside the edge. If it
// differs by more, it is that of the border of a tiny hole.
constexpr double hole_part = 0.1;

// Distances in domain lengths, the smallest first. If du x dv and its growth from the edge both vanish at a
// point, the normal is taken from a point at one of these distances, towards the midpoint of the domain.
constexpr double steps_inside[] = {0x1p-14, 0x1p-10, 0x1p-6};

// Derivatives at a surface point for parameters scaled to a domain of length 1, and an upper bound of |du x
// dv|. The bound is computed from the control points that affect the surface point.
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

template <class Real>
LimitTangents tangents_at(const KnotVector& u_knots, const KnotVector& v_knots, const NetView<Real>& net,
                          double u, double v) {
  const BasisFunctions bu = basis_functions(u_knots, u), bv = basis_functions(v_knots, v);
  const auto control = [&](int i, int j) {
    const int index = u_knots.control_index(bu.span, i) * net.columns + v_knots.control_index(bv.span, j);
    return Vector3(net.x[index], net.y[index], net.z[index]);
  };
  // Coordinates are relative to one control point, so that a large distance from (0, 0, 0) adds no rounding
  // noise.
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
  const double u_length = u_knots.domain_length(), v_length = v_knots.domain_length();
  tangents.du *= u_length;
  tangents.dv *= v_length;
  tangents.duu *= u_length * u_length;
  tangents.duv *= u_length * v_length;
  tangents.dvv *= v_length * v_length;
  tangents.product_bound = reach * reach * absolute_sum(bu, u_knots.degree(), u_length) *
                           absolute_sum(bv, v_knots.degree(), v_length);
  return tangents;
}

Vector3 normalize_product(const Vector3& product) {
  return product / product.norm();
}

bool exceeds(const Vector3& product, double threshold) {
  const double length = product.norm();
  return length > threshold && std::isfinite(length);
}

// Returns the sign of the direction from an end of an open domain into the domain: +1 at its start, -1 at its
// end, also beside it. Returns 0 elsewhere.
int inward(const KnotVector& knots, double u) {
  if (knots.is_periodic()) return 0;
  const double beside = hole * knots.domain_length();
  return u <= knots.domain_start() + beside ? 1 : u >= knots.domain_end() - beside ? -1 : 0;
}

// Returns the distance from the nearer end of a domain, in domain lengths.
double distance_from_end(const KnotVector& knots, double u) {
  return std::min(u - knots.domain_start(), knots.domain_end() - u) / knots.domain_length();
}

// Growth of du x dv per domain length, from the edge into the surface; zero away from edges.
struct Growth {
  Vector3 by_u = Vector3::Zero(), by_v = Vector3::Zero();
};

// Returns true if du x dv has grown from zero over the distance from an edge, which is thus a single point.
bool has_grown(const Vector3& product, const Vector3& growth, double distance) {
  const Vector3 grown = distance * growth;
  return (product - grown).norm() < hole_part * grown.norm();
}

Growth growth_from_edge(const LimitTangents& t, int inward_u, int inward_v) {
  return {inward_u * (t.duu.cross(t.dv) + t.du.cross(t.duv)),
          inward_v * (t.duv.cross(t.dv) + t.du.cross(t.dvv))};
}

// Returns u moved by the fraction `step` of the domain toward the midpoint of the domain, so that it stays
// inside.
double step_from(const KnotVector& knots, double u, double step) {
  const double length = knots.domain_length();
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
  const double threshold = product_noise<Real> * here.product_bound;
  const bool has_grown_here = has_grown(product, growth.by_u, distance_from_end(u_knots, u)) ||
                              has_grown(product, growth.by_v, distance_from_end(v_knots, v));
  if (has_grown_here && exceeds(product, threshold)) return normalize_product(product);
  if (exceeds(product, std::max({threshold, hole * growth.by_u.norm(), hole * growth.by_v.norm()}))) {
    return normalize_product(product);
  }
  if (exceeds(growth.by_v, threshold)) return normalize_product(growth.by_v);
  if (exceeds(growth.by_u, threshold)) return normalize_product(growth.by_u);

  for (const double step : steps_inside) {
    const double u_inside = step_from(u_knots, u, step), v_inside = step_from(v_knots, v, step);
    const double neighbours[][2] = {{u, v_inside}, {u_inside, v}, {u_inside, v_inside}};
    for (const auto& [nu, nv] : neighbours) {
      const LimitTangents there = tangents_at(u_knots, v_knots, net, nu, nv);
      const Vector3 product_there = there.du.cross(there.dv);
      if (exceeds(product_there, product_noise<Real> * there.product_bound))
        return normalize_product(product_there);
    }
  }
  return Vector3::Zero();
}

template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<float>&, double, double);
template Vector3 unit_normal(const KnotVector&, const KnotVector&, const NetView<double>&, double, double);

double stretch_bound_m(const Surface& surface) {
  SPOONBILL_ASSERT(has_matching_net(surface));
  const ControlNet& net = surface.net;
  const ControlLines<double> in_u{net.x.data(), net.y.data(), net.z.data(), net.columns, net.columns, 1};
  const ControlLines<double> in_v{net.x.data(), net.y.data(), net.z.data(), 1, net.rows, net.columns};
  return std::hypot(DerivativeBound(surface.u).longest(in_u), DerivativeBound(surface.v).longest(in_v));
}

}  // namespace spoonbill
