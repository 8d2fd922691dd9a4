// Contact of a moving rigid body with the ground, as constraints on points of its surface.
#pragma once

#include <optional>

#include "engine/material/contact/body_contacts.h"
#include "engine/scene/loads.h"
#include "engine/simulation/body_contact.h"
#include "engine/simulation/ground_contact.h"

namespace spoonbill {

// Owned by the simulation, which rebuilds it when the mapping of the body is replaced. add_contacts()
// allocates nothing.
class RigidGroundContact {
 public:
  // A body without dynamics never has contacts with the ground.
  explicit RigidGroundContact(const BodyState& body);

  // Adds constraints for points that can reach the ground in the coming tick of `time_s`. A rigid body rests
  // on the corners of the area in which it touches the ground. So only those points get a constraint that
  // touch the ground first when the body tilts slightly in some direction, or does not tilt. Returns false if
  // `contacts` is full.
  bool add_contacts(const IndexedBody& body, const Ground& ground, const Vector3& gravity_m_per_s2,
                    double time_s, BodyContacts& contacts);

 private:
  std::optional<SkinHeights> heights_;  // empty for a body without dynamics and for one with a mesh
};

}  // namespace spoonbill
