#include "engine/material/lattice/embedded_point.h"

#include <algorithm>
#include <cmath>

#include "engine/material/rigid/rigid_dynamics.h"

namespace spoonbill {
namespace {

constexpr float min_significant_weight = 0.05f;

Vector3 embedded_sum(const EmbeddedPoint& point, const float* x, const float* y, const float* z) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < point.count; ++i) {
    const int n = point.node[i];
    sum += static_cast<double>(point.weight[i]) * Vector3(x[n], y[n], z[n]);
  }
  return sum;
}

}  // namespace

bool EmbeddedPoint::add(const EmbeddedPoint& other, float fraction) {
  for (int i = 0; i < other.count; ++i) {
    // Points in the same cell have the same nodes in the same order.
    int at = i < count && node[i] == other.node[i] ? i : 0;
    while (at < count && node[at] != other.node[i]) ++at;
    if (at == capacity) return false;
    if (at == count) {
      node[at] = other.node[i];
      weight[at] = 0.0f;
      ++count;
    }
    weight[at] += fraction * other.weight[i];
  }
  return true;
}

double EmbeddedPoint::weight_of_node(int node_index) const {
  for (int i = 0; i < count; ++i) {
    if (node[i] == node_index) return weight[i];
  }
  return 0.0;
}

Vector3 EmbeddedPoint::rest_m(const SpringLattice& lattice) const {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < count; ++i) sum += static_cast<double>(weight[i]) * lattice.mesh().nodes[node[i]];
  return sum;
}

Vector3 EmbeddedPoint::position_m(const SpringLattice& lattice) const {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < count; ++i) sum += static_cast<double>(weight[i]) * lattice.position(node[i]);
  return sum;
}

namespace {

template <class InverseMassOf>
double sum_compliance(const EmbeddedPoint& point, const InverseMassOf& inverse_mass_of) {
  WeightedCompliance compliance;
  for (int i = 0; i < point.count; ++i) compliance.add(point.weight[i], inverse_mass_of(point.node[i]));
  return compliance.per_kg();
}

}  // namespace

double EmbeddedPoint::compliance(const SpringLattice& lattice) const {
  return sum_compliance(*this, [&](int at) { return lattice.inverse_mass(at); });
}

double EmbeddedPoint::compliance(const LatticeView& lattice) const {
  if (lattice.rigid) return lattice.rigid->any_compliance(offset_m(*lattice.rigid));
  return sum_compliance(*this, [&](int at) { return lattice.inverse_mass[at]; });
}

Vector3 EmbeddedPoint::offset_m(const RigidDynamics& rigid) const {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < count; ++i) sum += static_cast<double>(weight[i]) * rigid.offset_m(node[i]);
  return sum;
}

double EmbeddedPoint::friction(const SpringLattice& lattice) const {
  if (lattice.materials().friction_index.empty() || count == 0) return lattice.material().friction;
  double sum = 0.0, least = lattice.friction(node[0]), most = least;
  for (int i = 0; i < count; ++i) {
    const double own = lattice.friction(node[i]);
    sum += static_cast<double>(weight[i]) * own;
    least = std::min(least, own);
    most = std::max(most, own);
  }
  return std::clamp(sum, least, most);
}

Vector3 EmbeddedPoint::displacement_m(const SpringLattice& lattice) const {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < count; ++i) sum += static_cast<double>(weight[i]) * lattice.displacement(node[i]);
  return sum;
}

Vector3 EmbeddedPoint::displacement_m(const LatticeView& lattice) const {
  return embedded_sum(*this, lattice.dx, lattice.dy, lattice.dz);
}

Vector3 EmbeddedPoint::velocity_m_per_s(const LatticeView& lattice) const {
  if (lattice.rigid) return lattice.rigid->velocity_m_per_s(offset_m(*lattice.rigid));
  const Vector3 relative = embedded_sum(*this, lattice.vx, lattice.vy, lattice.vz);
  return lattice.frame ? Vector3(lattice.frame->velocity_m_per_s + relative) : relative;
}

void EmbeddedPoint::shift(const LatticeView& lattice, const Vector3& impulse, double time_s) const {
  if (lattice.rigid) return lattice.rigid->shift(lattice, offset_m(*lattice.rigid), impulse, time_s);
  for (int i = 0; i < count; ++i) {
    const int n = node[i];
    const Vector3 by = time_s * static_cast<double>(weight[i] * lattice.inverse_mass[n]) * impulse;
    const float x = static_cast<float>(by.x()), y = static_cast<float>(by.y()),
                z = static_cast<float>(by.z());
    lattice.dx[n] += x;
    lattice.dy[n] += y;
    lattice.dz[n] += z;
    lattice.moved_x[n] += x;
    lattice.moved_y[n] += y;
    lattice.moved_z[n] += z;
  }
}

void EmbeddedPoint::push(const LatticeView& lattice, const Vector3& impulse) const {
  if (lattice.rigid) return lattice.rigid->push(offset_m(*lattice.rigid), impulse);
  for (int i = 0; i < count; ++i) {
    const int n = node[i];
    const double fraction = static_cast<double>(weight[i]) * static_cast<double>(lattice.inverse_mass[n]);
    lattice.vx[n] += static_cast<float>(fraction * impulse.x());
    lattice.vy[n] += static_cast<float>(fraction * impulse.y());
    lattice.vz[n] += static_cast<float>(fraction * impulse.z());
  }
  if (!lattice.frame) return;
  lattice.frame->velocity_m_per_s += lattice.frame->compliance * impulse;
  lattice.frame->impulse_ns += impulse;
}

void EmbeddedPoint::mark(std::uint8_t* touched) const {
  for (int i = 0; i < count; ++i) {
    if (std::abs(weight[i]) > min_significant_weight) touched[node[i]] = 1;
  }
}

}  // namespace spoonbill
