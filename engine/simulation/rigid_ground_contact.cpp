#include "engine/simulation/rigid_ground_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/assert.h"
#include "engine/simulation/support_points.h"

namespace spoonbill {
namespace {

// Points of a surface that are nearer to each other than this count as one.
constexpr double same_point_m = 1e-5;

// A point of a surface near the ground.
struct SurfaceSupport {
  Vector3 direction;  // along which the point is the farthest
  double u, v;
  Vector3 point_m;
};

// Returns the point of a sample that the ground can touch: that of the far face if this face of a shell looks
// away from the ground.
Vector3 find_touched_m(const Surface& surface, double thickness_m, double u, double v,
                       const Vector3& ground_normal) {
  const Vector3 point_m = position(surface, u, v);
  if (thickness_m == 0.0) return point_m;
  const Vector3 normal = unit_normal(surface, u, v);
  return normal.dot(ground_normal) > 0.0 ? Vector3(point_m - thickness_m * normal) : point_m;
}

// Moves a support point from its sample to the exact maximum near it, by Newton's method in units of the
// spacing of the samples. On a flat face the point stays.
void polish(const Surface& surface, double u_spacing, double v_spacing, SurfaceSupport& point) {
  constexpr int most_steps = 4;
  constexpr double least_gain_m = 1e-9;
  SurfacePoint at = evaluate(surface, point.u, point.v);
  for (int step = 0; step < most_steps; ++step) {
    const Vector3& d = point.direction;
    const Eigen::Vector2d slope(u_spacing * d.dot(at.du), v_spacing * d.dot(at.dv));
    const double uu = u_spacing * u_spacing * d.dot(at.duu), vv = v_spacing * v_spacing * d.dot(at.dvv);
    const double uv = u_spacing * v_spacing * d.dot(at.duv);
    Eigen::Matrix2d bend;
    bend << -uu, -uv, -uv, -vv;
    // The point must not run away where the surface hardly bends, as along a cylinder.
    bend += (1e-3 * std::abs(bend.trace()) + 1e-9) * Eigen::Matrix2d::Identity();
    if (!(bend.determinant() > 0.0 && bend.trace() > 0.0)) return;
    const Eigen::Vector2d move = bend.inverse() * slope;
    const double longest = std::max(1.0, move.cwiseAbs().maxCoeff());
    const double u = surface.u.into_domain(point.u + move.x() / longest * u_spacing);
    const double v = surface.v.into_domain(point.v + move.y() / longest * v_spacing);
    at = evaluate(surface, u, v);
    const double gain_m = d.dot(at.position_m - point.point_m);
    if (!(gain_m > 0.0)) return;
    point.u = u;
    point.v = v;
    point.point_m = at.position_m;
    if (gain_m < least_gain_m) return;
  }
}

double spacing_at(const std::vector<double>& parameters, int index) {
  const std::size_t last = parameters.size() - 1, at = std::min(static_cast<std::size_t>(index), last - 1);
  return parameters[at + 1] - parameters[at];
}

// Adds constraints for the vertices of a mesh. The lowest points of a mesh are vertices.
bool add_mesh_contacts(const IndexedBody& body, const Ground& ground, double margin_m,
                       BodyContacts& contacts) {
  const MeshMapping& mesh = *body.state->mesh();
  const std::vector<Vector3>& vertices_m = mesh.current().vertices_m();
  const auto gap_m = [&](std::size_t v) { return ground.normal.dot(vertices_m[v] - ground.point_m); };
  SupportPoints lowest(ground.normal);
  for (std::size_t v = 0; v < vertices_m.size(); ++v) {
    if (gap_m(v) <= margin_m) lowest.offer(static_cast<int>(v), vertices_m[v], gap_m(v));
  }
  bool complete = true;
  const auto& supports = lowest.supports();
  for (std::size_t p = 0; p < supports.size(); ++p) {
    const int vertex = supports[p].index;
    if (vertex < 0) break;
    const bool is_known = std::any_of(supports.begin(), supports.begin() + static_cast<std::ptrdiff_t>(p),
                                      [&](const auto& other) { return other.index == vertex; });
    if (is_known) continue;
    const BodyPoint point{body.index, &body.state->lattice, mesh.vertex(static_cast<std::uint32_t>(vertex))};
    complete &= contacts.add_on_ground(point, ground.normal, gap_m(static_cast<std::size_t>(vertex)),
                                       ground.friction, vertex);
  }
  return complete;
}

}  // namespace

RigidGroundContact::RigidGroundContact(const BodyState& body) {
  if (!body.is_movable_rigid() || body.mesh()) return;
  const Surface& surface = body.mapping().current();
  // make() cannot fail, because the mapping already has a grid of these knots.
  heights_ = SkinHeights::make(surface.u, surface.v).value();
}

bool RigidGroundContact::add_contacts(const IndexedBody& body, const Ground& ground,
                                      const Vector3& gravity_m_per_s2, double time_s,
                                      BodyContacts& contacts) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  if (body.state->mesh() && body.state->is_movable_rigid()) {
    return add_mesh_contacts(body, ground, find_ground_margin_m(*body.state, gravity_m_per_s2, time_s),
                             contacts);
  }
  if (!heights_) return true;
  const BodyState& state = *body.state;
  const double thickness_m = state.shell_thickness_m;
  const double margin_m = find_ground_margin_m(state, gravity_m_per_s2, time_s);
  const Surface& surface = state.mapping().current();
  if (!heights_->compute(surface, ground.point_m, ground.normal, margin_m + thickness_m)) return true;
  SupportPoints lowest(ground.normal);
  for (int row = 0; row < heights_->rows(); ++row) {
    for (int column = 0; column < heights_->columns(); ++column) {
      if (!(heights_->lowest_m(row, column) <= margin_m + thickness_m)) continue;
      const double u = heights_->u(row), v = heights_->v(column);
      if (state.trim && !state.trim->contains(u, v)) continue;
      const Vector3 point_m = find_touched_m(surface, thickness_m, u, v, ground.normal);
      lowest.offer(row * heights_->columns() + column, point_m, ground.normal.dot(point_m - ground.point_m));
    }
  }
  std::array<SurfaceSupport, SupportPoints::count> found;
  bool complete = true;
  int count = 0;
  for (std::size_t p = 0; p < found.size(); ++p) {
    const SupportPoints::Support& support = lowest.supports()[p];
    if (support.index < 0) break;
    const int row = support.index / heights_->columns(), column = support.index % heights_->columns();
    const double u = heights_->u(row), v = heights_->v(column);
    SurfaceSupport& point = found[static_cast<std::size_t>(count)];
    point = {support.direction, u, v, find_touched_m(surface, thickness_m, u, v, ground.normal)};
    if (thickness_m == 0.0 && !state.trim) {
      polish(surface, spacing_at(heights_->u_parameters(), row), spacing_at(heights_->v_parameters(), column),
             point);
    }
    const bool is_known = std::any_of(found.begin(), found.begin() + count, [&](const SurfaceSupport& other) {
      return (other.point_m - point.point_m).norm() < same_point_m;
    });
    const double gap_m = ground.normal.dot(point.point_m - ground.point_m);
    if (is_known || gap_m > margin_m) continue;
    ++count;
    const BodyPoint embedded{body.index, &state.lattice, state.mapping().at(point.u, point.v)};
    complete &= contacts.add_on_ground(embedded, ground.normal, gap_m, ground.friction, static_cast<int>(p));
  }
  return complete;
}

}  // namespace spoonbill
