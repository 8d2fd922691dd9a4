// The supports of one body on the nodes of its lattice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/material/springs/spring_lattice.h"
#include "engine/material/supports/supported_nodes.h"
#include "engine/scene/loads.h"

namespace spoonbill {

// One owner, the body; begin_tick() allocates nothing. How far a support is follows from where its nodes are.
class BodySupports {
 public:
  BodySupports() = default;
  // As they are before the first tick. Refused, with the support's place in the list: one whose region holds
  // no node of the lattice.
  static Result<BodySupports> make(const std::vector<Support>& supports, const LatticeMesh& mesh);

  // Takes the nodes that nothing holds yet, and marks them: one byte a node, 1 = held.
  void take_nodes(const SpringLattice& lattice, std::vector<std::uint8_t>& held);
  // The lattice's displacements now count from another shape.
  void begin_anew(const SpringLattice& before, const SpringLattice& now);

  // For a tick that ends at `end_s` and takes `tick_s` of the same time.
  std::span<SupportedNodes> begin_tick(const SpringLattice& lattice, double end_s, double tick_s);

  std::span<const SupportedNodes> supports() const { return supported_; }

 private:
  std::vector<Support> as_set_;
  std::vector<std::vector<int>> of_region_;  // nodes of each
  std::vector<SupportedNodes> supported_;
};

}  // namespace spoonbill
