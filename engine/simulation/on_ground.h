// Where the bodies of a scene come near the ground, as constraints on their lattices.
#pragma once

#include <span>
#include <vector>

#include "engine/material/contact/ground_contacts.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/loads.h"

namespace spoonbill {

// How deep the skin of a body that lies on the ground comes to be in it, in lattice cells: what hangs on a
// node turns with its neighbours too, and the control net follows a dent only in part.
inline constexpr double ground_depth_limit_cells = 0.1;

// One owner, the simulation; rebuilt with the mapping of a body. find() allocates nothing.
class OnGround {
 public:
  explicit OnGround(std::span<const BodyState> bodies);

  // Constrains each node that something of the surface hangs on which the coming tick, of `time_s` of
  // material time, can bring to the ground.
  void find(std::span<const BodyState> bodies, const Ground& ground, const Vector3& gravity_m_per_s2,
            double time_s);

  GroundContacts& contacts() { return contacts_; }
  const GroundContacts& contacts() const { return contacts_; }

 private:
  // A node on the surface; the samples of the skin that are nearest to it hang on it.
  struct Footing {
    int node = 0;
    int first = 0, count = 0;  // in samples
  };
  struct BodyFootings {
    std::vector<Footing> footings;
    std::vector<int> samples;
  };

  void find(int number, const BodyState& body, const Ground& ground, double reach_m);

  std::vector<BodyFootings> bodies_;
  GroundContacts contacts_;
};

}  // namespace spoonbill
