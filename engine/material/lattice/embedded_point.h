// Points of a body as weighted sums of its lattice's nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// The frame of a soft tool, which moves with the tool's proxy. The velocities of the tool's lattice are
// relative to it, so that the lattice's inertia, which may be thousands of times the real one, resists a
// change of shape but not the motion of the hand. A push on the lattice also pushes the frame. The kinetic
// energy is that of the frame plus that of the lattice's motion relative to it, so that contacts do not
// generate energy. Like all tools, a soft tool has no weight in the hand.
struct MovingFrame {
  Vector3 velocity_m_per_s = Vector3::Zero();
  double compliance = 0.0;  // velocity change of the frame per impulse, 1/kg; 0 if the hand holds it rigidly
  Vector3 impulse_ns = Vector3::Zero();  // sum of all pushes on the lattice
};

// Returns the velocity change of a lattice's frame per impulse, 1/kg; 0 without a frame.
inline double frame_compliance(const LatticeView& lattice) {
  return lattice.frame ? lattice.frame->compliance : 0.0;
}

// Compliance of a point whose nodes get impulses by their weights. Where nearly all of the weight is on fixed
// nodes, the sum alone would be so small that its few free nodes would get most of a push, many times as fast
// as the point itself.
class WeightedCompliance {
 public:
  void add(double weight, double inverse_mass) {
    sum_ += weight * weight * inverse_mass;
    fastest_ = std::max(fastest_, std::abs(weight) * inverse_mass);
  }
  // Returns at least the compliance for which no node becomes more than 10 times as fast as the point.
  double per_kg() const { return std::max(sum_, 0.1 * fastest_); }

 private:
  double sum_ = 0.0, fastest_ = 0.0;
};

// A weighted sum of nodes. Weights sum to 1; some are negative where the surface is outside its cells.
struct EmbeddedPoint {
  static constexpr int capacity = 32;
  int count = 0;
  std::array<int, capacity> node{};
  std::array<float, capacity> weight{};

  // Adds `fraction` times the other point's weights, merging equal nodes. Returns false if the capacity is
  // exceeded.
  bool add(const EmbeddedPoint& other, float fraction);

  // Returns the weight of a node, or 0 if the point does not use it.
  double weight_of_node(int node_index) const;
  // Position in the undeformed lattice, m.
  Vector3 rest_m(const SpringLattice& lattice) const;
  // Position in the deformed lattice, m.
  Vector3 position_m(const SpringLattice& lattice) const;
  // Velocity change of the point per impulse, 1/kg, relative to the lattice's frame, see WeightedCompliance;
  // 0 if all of its nodes are fixed.
  double compliance(const SpringLattice& lattice) const;
  // For a rigid body that contacts can move, this is an upper bound.
  double compliance(const LatticeView& lattice) const;
  // Offset of the point from the centre of mass of a rigid body that contacts can move, m.
  Vector3 offset_m(const RigidDynamics& rigid) const;
  // Returns the weighted mean of the nodes' friction coefficients, limited to the range of these
  // coefficients.
  double friction(const SpringLattice& lattice) const;
  Vector3 displacement_m(const SpringLattice& lattice) const;
  Vector3 displacement_m(const LatticeView& lattice) const;
  // Velocity in the world frame.
  Vector3 velocity_m_per_s(const LatticeView& lattice) const;
  // Distributes an impulse, N s, to the nodes, or pushes the rigid body. Also pushes the lattice's frame.
  void push(const LatticeView& lattice, const Vector3& impulse) const;
  // Moves the nodes in the direction of an impulse, without changing velocities: each by its part of the
  // impulse times its inverse mass times `time_s`. Moves a rigid body as a whole. The second nodes of seam
  // pairs stay behind (see join_seam_positions()).
  void shift(const LatticeView& lattice, const Vector3& impulse, double time_s) const;
  // Calls visit(node, part) for each node and its part of an impulse.
  template <class Visit>
  void visit_shares(const Vector3& impulse, const Visit& visit) const {
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      visit(node[at], Vector3(static_cast<double>(weight[at]) * impulse));
    }
  }
  // Sets touched[n] to 1 for each node n with a significant weight.
  void mark(std::uint8_t* touched) const;
};

}  // namespace spoonbill
