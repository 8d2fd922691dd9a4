// Points of a body as weighted sums of its lattice's nodes.
#pragma once

#include <array>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// A weighted sum of nodes. Weights sum to 1; some may be slightly negative where the surface bulges out of
// its cells.
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
  // Velocity change of the point per impulse, 1/kg; 0 if all of its nodes are fixed.
  double compliance(const SpringLattice& lattice) const;
  double compliance(const LatticeView& lattice) const;
  // Returns the weighted mean of the nodes' friction coefficients, limited to the range of these
  // coefficients.
  double friction(const SpringLattice& lattice) const;
  Vector3 displacement_m(const LatticeView& lattice) const;
  Vector3 velocity_m_per_s(const LatticeView& lattice) const;
  // Distributes an impulse, N s, to the nodes.
  void push(const LatticeView& lattice, const Vector3& impulse) const;
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
