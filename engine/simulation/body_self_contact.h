// A body of a simulation that is bent onto itself: where its surface comes near another part of it from
// outside, as constraints between two points of its own lattice.
#pragma once

#include <memory>

#include "engine/collision/proximity/self_proximity.h"
#include "engine/simulation/body_pair_contact.h"

namespace spoonbill {

// How deep a body whose sides are pressed onto each other comes to be in itself at most, in lattice cells:
// twice what two bodies come to, since both sides follow a dent only in part.
inline constexpr double self_depth_limit_cells = 2.0 * body_depth_limit_cells;

// One owner, the simulation; rebuilt with the mapping of the body. add_contacts() allocates nothing. A body
// in a box of cells (solid_lattice.h) that is thinner than two of them somewhere does not meet itself: its
// far side would look like its near one pressed through it.
class BodySelfContact {
 public:
  explicit BodySelfContact(const BodyState& body);

  // Adds a constraint for each point that is near another part of the body. False where a capacity was met.
  bool add_contacts(const NumberedBody& body, BodyContacts& contacts) const;

 private:
  std::unique_ptr<SelfProximity> proximity_;  // by pointer: it does not move; none of a mesh
};

}  // namespace spoonbill
