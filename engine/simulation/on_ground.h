// Where the bodies of a scene come near the ground, as constraints on their lattices.
#pragma once

#include <span>
#include <vector>

#include "engine/material/contact/ground_contacts.h"
#include "engine/scene/loads.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/skin_heights.h"

namespace spoonbill {

// How deep the skin of a body may be in the ground on which it rests, in lattice cells.
inline constexpr double ground_depth_limit_cells = 0.01;

// One owner, the simulation; rebuilt with the mapping of a body. find() allocates nothing.
class OnGround {
 public:
  explicit OnGround(std::span<const BodyState> bodies);

  // Constrains each node that something of the surface hangs on which the coming tick, of `time_s` of
  // material time, can bring to the ground.
  void find(std::span<const BodyState> bodies, const Ground& ground, const Vector3& gravity_m_per_s2,
            double time_s);

  // All that the next tick depends on.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    contacts_.visit_state(visit);
    for (const BodyFootings& of_body : bodies_) {
      for (const Footing& footing : of_body.footings) {
        if (footing.is_near) visit(&footing.skin_m, 1);
      }
    }
  }

  GroundContacts& contacts() { return contacts_; }
  const GroundContacts& contacts() const { return contacts_; }

 private:
  // A node on the surface, or of a box of cells one that any of the surface hangs on; with what hangs on it:
  // samples of the mapping, which follow the lattice, and the skin that the control net makes of them, which
  // lies a little elsewhere. Of a box, which has nodes beside the surface, each has a sample: where none
  // hangs on it, those nearest to its skin.
  struct Footing {
    int node = 0;
    int first_followed = 0, followed_count = 0;  // in followed
    int first = 0, count = 0;                    // in samples
    double skin_m = 0.0;                         // how much higher the skin is, as far as learnt
    bool is_near = false;                        // to the ground, in the last tick
  };
  struct Sample {
    int row = 0, column = 0;
  };
  struct Hung {  // on a node
    std::vector<int> followed;
    std::vector<Sample> skin;
  };
  struct BodyFootings {
    SkinHeights heights;
    double hang_m;  // how far from its node anything hangs, at rest
    std::vector<Footing> footings;
    std::vector<int> followed;  // of the mapping
    std::vector<Sample> samples;
  };

  static std::vector<Hung> hung_on_nodes(const BodyState& body, const SkinHeights& heights);
  static BodyFootings footings_of(const BodyState& body);
  void find(int number, const BodyState& body, const Ground& ground, double reach_m, double time_s);
  void take_skin(const BodyFootings& of_body, double followed_m, double time_s, Footing& footing) const;

  std::vector<BodyFootings> bodies_;
  GroundContacts contacts_;
};

}  // namespace spoonbill
