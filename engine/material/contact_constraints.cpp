#include "engine/material/contact_constraints.h"

#include <algorithm>

namespace spoonbill {
namespace {

// The share of a penetration that one substep takes back: below 1, so that neighbouring points that push the same
// node do not overshoot together.
constexpr double correction_share = 0.3;

Vector3 embedded_sum(const EmbeddedPoint& point, const float* x, const float* y, const float* z) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < point.count; ++i) {
    const int n = point.node[i];
    sum += static_cast<double>(point.weight[i]) * Vector3(x[n], y[n], z[n]);
  }
  return sum;
}

// Gives the point the velocity change impulse / effective mass by spreading the impulse over its nodes.
void apply_impulse(const LatticeView& lattice, const EmbeddedPoint& point, const Vector3& impulse) {
  for (int i = 0; i < point.count; ++i) {
    const int n = point.node[i];
    const double share = static_cast<double>(point.weight[i]) * static_cast<double>(lattice.inverse_mass[n]);
    lattice.vx[n] += static_cast<float>(share * impulse.x());
    lattice.vy[n] += static_cast<float>(share * impulse.y());
    lattice.vz[n] += static_cast<float>(share * impulse.z());
  }
}

}  // namespace

bool EmbeddedPoint::add(const EmbeddedPoint& other, float share) {
  for (int i = 0; i < other.count; ++i) {
    int at = 0;
    while (at < count && node[at] != other.node[i]) ++at;
    if (at == capacity) return false;
    if (at == count) {
      node[at] = other.node[i];
      weight[at] = 0.0f;
      ++count;
    }
    weight[at] += share * other.weight[i];
  }
  return true;
}

ContactConstraints::ContactConstraints(int capacity) : constraints_(static_cast<std::size_t>(capacity)) {}

void ContactConstraints::clear() { count_ = 0; }

bool ContactConstraints::add_push(const SpringLattice& lattice, const EmbeddedPoint& point) {
  return add(lattice, point, Kind::sphere_push, Vector3::Zero());
}

bool ContactConstraints::add_plane_push(const SpringLattice& lattice, const EmbeddedPoint& point,
                                        const Vector3& normal) {
  return add(lattice, point, Kind::plane_push, normal);
}

bool ContactConstraints::add_grip(const SpringLattice& lattice, const EmbeddedPoint& point, const Vector3& offset_m) {
  return add(lattice, point, Kind::grip, offset_m);
}

bool ContactConstraints::add(const SpringLattice& lattice, const EmbeddedPoint& point, Kind kind,
                             const Vector3& direction) {
  if (count_ == static_cast<int>(constraints_.size())) return false;
  Constraint& constraint = constraints_[count_++];
  constraint = {kind, point, Vector3::Zero(), direction, 0.0f, false};
  double compliance = 0.0;
  for (int i = 0; i < point.count; ++i) {
    const double weight = point.weight[i];
    constraint.rest_m += weight * lattice.mesh().nodes[point.node[i]];
    compliance += weight * weight * lattice.inverse_mass(point.node[i]);
  }
  constraint.effective_mass = compliance > 0.0 ? static_cast<float>(1.0 / compliance) : 0.0f;
  return true;
}

void ContactConstraints::begin(const ToolMotion& motion, double material_time_s) {
  motion_ = motion;
  tool_velocity_ = (motion.end_m - motion.start_m) / material_time_s;
  tool_impulse_.setZero();
  acted_ = false;
  for (int c = 0; c < count_; ++c) constraints_[c].acted = false;
}

void ContactConstraints::solve(const LatticeView& lattice, float h, float fraction, float cap) {
  const Vector3 centre = motion_.start_m + static_cast<double>(fraction) * (motion_.end_m - motion_.start_m);
  const Quaternion orientation(motion_.start_orientation.coeffs() * (1.0 - static_cast<double>(fraction)) +
                               motion_.end_orientation.coeffs() * static_cast<double>(fraction));
  for (int c = 0; c < count_; ++c) {
    Constraint& constraint = constraints_[c];
    if (constraint.effective_mass == 0.0f) continue;
    if (constraint.kind == Kind::grip) {
      solve_grip(lattice, constraint, centre, orientation.normalized(), h, cap);
    } else {
      solve_push(lattice, constraint, centre, h, cap);
    }
  }
}

void ContactConstraints::solve_push(const LatticeView& lattice, Constraint& constraint, const Vector3& centre, float h,
                                    float cap) {
  const Vector3 position = constraint.rest_m + embedded_sum(constraint.point, lattice.dx, lattice.dy, lattice.dz);
  const bool plane = constraint.kind == Kind::plane_push;
  const Vector3 from_centre = position - centre;
  const double distance = plane ? -from_centre.dot(constraint.direction) : from_centre.norm();
  if (!plane && !(distance > 0.0)) return;
  const Vector3 normal = plane ? Vector3(-constraint.direction) : Vector3(from_centre / distance);
  const double gap = distance - motion_.radius_m;
  const Vector3 velocity = embedded_sum(constraint.point, lattice.vx, lattice.vy, lattice.vz);
  const double separating = (velocity - tool_velocity_).dot(normal);
  const double wanted =
      gap > 0.0 ? -gap / h : std::min(-gap * correction_share / h, static_cast<double>(cap));
  if (separating >= wanted) return;
  const Vector3 impulse = (wanted - separating) * constraint.effective_mass * normal;
  apply_impulse(lattice, constraint.point, impulse);
  tool_impulse_ -= impulse;
  constraint.acted = true;
  acted_ = true;
}

void ContactConstraints::solve_grip(const LatticeView& lattice, Constraint& constraint, const Vector3& centre,
                                    const Quaternion& orientation, float h, float cap) {
  const Vector3 position = constraint.rest_m + embedded_sum(constraint.point, lattice.dx, lattice.dy, lattice.dz);
  const Vector3 miss = centre + orientation * constraint.direction - position;
  Vector3 wanted = miss * (correction_share / h);
  const double speed = wanted.norm();
  if (speed > cap) wanted *= cap / speed;
  const Vector3 velocity = embedded_sum(constraint.point, lattice.vx, lattice.vy, lattice.vz);
  const Vector3 impulse = (tool_velocity_ + wanted - velocity) * constraint.effective_mass;
  apply_impulse(lattice, constraint.point, impulse);
  tool_impulse_ -= impulse;
  constraint.acted = true;
  acted_ = true;
}

void ContactConstraints::mark_touched(std::uint8_t* touched) const {
  for (int c = 0; c < count_; ++c) {
    if (!constraints_[c].acted) continue;
    for (int i = 0; i < constraints_[c].point.count; ++i) {
      if (constraints_[c].point.weight[i] > 0.05f) touched[constraints_[c].point.node[i]] = 1;
    }
  }
}

}  // namespace spoonbill
