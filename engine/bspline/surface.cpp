#include "engine/bspline/surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/number_text.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/unit_normal.h"

namespace spoonbill {

namespace {

Status check_coordinates(const ControlNet& net, const std::vector<double>& values, char coordinate) {
  if (values.size() != net.size()) {
    return Error{std::string("control points: ") + std::to_string(values.size()) + " " + coordinate +
                 " coordinates for a net of " + std::to_string(net.rows) + " x " +
                 std::to_string(net.columns) + "; give " + std::to_string(net.size())};
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) {
      const std::size_t columns = static_cast<std::size_t>(net.columns);
      return Error{"control point (" + std::to_string(k / columns) + ", " + std::to_string(k % columns) +
                   "): " + coordinate + " (" + number_text(values[k]) +
                   ") is not a finite number; replace it"};
    }
  }
  return {};
}

}  // namespace

Box box_of(const ControlNet& net) {
  Box box;
  for (std::size_t k = 0; k < net.size(); ++k) box.include({net.x[k], net.y[k], net.z[k]});
  return box;
}

Result<Surface> make_surface(KnotVector u, KnotVector v, ControlNet net) {
  if (net.rows != u.control_point_count() || net.columns != v.control_point_count()) {
    return Error{"control net of " + std::to_string(net.rows) + " x " + std::to_string(net.columns) +
                 " does not fit the knots, which ask for " + std::to_string(u.control_point_count()) + " x " +
                 std::to_string(v.control_point_count()) + "; change the net or the knots"};
  }
  if (Status status = check_coordinates(net, net.x, 'x'); !status) return status.error();
  if (Status status = check_coordinates(net, net.y, 'y'); !status) return status.error();
  if (Status status = check_coordinates(net, net.z, 'z'); !status) return status.error();
  return Surface{std::move(u), std::move(v), std::move(net)};
}

bool has_size_of_knots(const Surface& surface) {
  const ControlNet& net = surface.net;
  return net.rows > 0 && net.rows == surface.u.control_point_count() &&
         net.columns == surface.v.control_point_count() && net.x.size() == net.size() &&
         net.y.size() == net.size() && net.z.size() == net.size();
}

bool is_valid(const Surface& surface) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  return has_size_of_knots(surface) && std::all_of(surface.net.x.begin(), surface.net.x.end(), is_finite) &&
         std::all_of(surface.net.y.begin(), surface.net.y.end(), is_finite) &&
         std::all_of(surface.net.z.begin(), surface.net.z.end(), is_finite);
}

Surface placed(Surface surface, const Pose& pose) {
  SPOONBILL_ASSERT(has_size_of_knots(surface));
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
  SPOONBILL_ASSERT_DEBUG(has_size_of_knots(surface));
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
  SPOONBILL_ASSERT_DEBUG(has_size_of_knots(surface));
  // Only values[0] is ever read.
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
  SPOONBILL_ASSERT_DEBUG(has_size_of_knots(surface));
  return unit_normal(
      surface.u, surface.v,
      NetView<double>{surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), surface.net.columns},
      u, v);
}

}  // namespace spoonbill
