// The tool on the body: finds where it touches the surface and turns that into constraints on the lattice.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/collision/surface_collider.h"
#include "engine/material/contact_constraints.h"
#include "engine/simulation/body_mapping.h"
#include "engine/simulation/scene.h"

namespace spoonbill {

// One owner, the simulation; rebuilt with the body's mapping. prepare() allocates nothing.
class ToolContact {
 public:
  explicit ToolContact(const BodyMapping& mapping);

  // Finds the contact of the tool at `pose` and sets the constraints of this tick. A push lets go as the tool
  // leaves, and so does smoothing, which slides; a pull grips what it first touches while `gripping` and
  // holds it until the button is released.
  // While `hovering`, and then until it is outside the body, the tool acts on nothing.
  void prepare(const BodyMapping& mapping, const SpringLattice& lattice, const Tool& tool, const Pose& pose,
               bool gripping, bool hovering);
  void release();
  // Acts on nothing from the next prepare() on until the button is free and the tool has left the body, by a
  // margin or hovering.
  void lift();
  bool lifted() const { return lifted_; }
  bool hovered() const { return hovered_; }

  ContactConstraints& constraints() { return constraints_; }
  const ContactConstraints& constraints() const { return constraints_; }
  const CollisionResult& collision() const { return collision_; }
  bool overflow() const { return overflow_; }

 private:
  void add_pushes(const BodyMapping& mapping, const SpringLattice& lattice);
  void add_grips(const BodyMapping& mapping, const SpringLattice& lattice, const Pose& pose);

  SurfaceCollider collider_;
  ContactConstraints constraints_;
  CollisionResult collision_;
  bool gripped_ = false;
  bool lifted_ = false;
  bool hovered_ = false;
  bool overflow_ = false;
};

}  // namespace spoonbill
