// Points of a body as weighted sums of its lattice's nodes.
#pragma once

#include <array>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Weights sum to 1; a few may be slightly negative where the surface bulges out of its cells.
struct EmbeddedPoint {
  static constexpr int capacity = 32;
  int count = 0;
  std::array<int, capacity> node{};
  std::array<float, capacity> weight{};

  // Adds share * the other point's weights, merging equal nodes. False when the capacity is exceeded.
  bool add(const EmbeddedPoint& other, float share);

  // The weight of a node, 0 of one that it does not have.
  double share_of(int node_index) const;
  // In the undeformed lattice.
  Vector3 rest_m(const SpringLattice& lattice) const;
  // What an impulse on the point gives it of velocity, 1/kg; 0 when every node is held.
  double compliance(const SpringLattice& lattice) const;
  // The mean of its nodes', by their weights; between the least and the most of them.
  double friction(const SpringLattice& lattice) const;
  Vector3 displacement_m(const LatticeView& lattice) const;
  Vector3 velocity_m_per_s(const LatticeView& lattice) const;
  // Spreads an impulse, N s, over the nodes.
  void push(const LatticeView& lattice, const Vector3& impulse) const;
  // Sets the bytes of the nodes that matter to it.
  void mark(std::uint8_t* touched) const;
};

}  // namespace spoonbill
