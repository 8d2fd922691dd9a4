// The tool on the bodies: finds where it touches their surfaces and turns that into constraints on their
// lattices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/collision/surface_collider.h"
#include "engine/material/contact_constraints.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/scene.h"

namespace spoonbill {

// One owner, the simulation; rebuilt with the mapping of a body. prepare() allocates nothing.
class ToolContact {
 public:
  explicit ToolContact(std::span<const BodyState> bodies);

  // Finds the contacts of the tool at `pose` and sets the constraints of this tick. A push lets go as the
  // tool leaves, and so does smoothing, which slides; a pull grips what it first touches while `gripping` and
  // holds it until the button is released.
  // While `hovering`, and then until it is outside the bodies, the tool acts on nothing.
  void prepare(std::span<const BodyState> bodies, const Tool& tool, const Pose& pose, bool gripping,
               bool hovering);
  void release();
  // Acts on nothing from the next prepare() on until the button is free and the tool has left the bodies, by
  // a margin or hovering.
  void lift();
  bool lifted() const { return lifted_; }
  bool hovered() const { return hovered_; }

  ContactConstraints& constraints() { return constraints_; }
  const ContactConstraints& constraints() const { return constraints_; }
  // With one of the bodies, and with which the tool is deepest in.
  const CollisionResult& collision(int body) const { return contacts_[body].collision; }
  int deepest_body() const;
  bool overflow() const { return overflow_; }

 private:
  struct BodyContact {
    explicit BodyContact(const BodyMapping& mapping) : collider(mapping.nested()) {}
    SurfaceCollider collider;
    CollisionResult collision;
  };
  void add_pushes(int body, const BodyState& state);
  void add_grips(int body, const BodyState& state, const Pose& pose);

  std::vector<BodyContact> contacts_;  // one a body
  ContactConstraints constraints_;
  bool gripped_ = false;
  bool lifted_ = false;
  bool hovered_ = false;
  bool overflow_ = false;
};

}  // namespace spoonbill
