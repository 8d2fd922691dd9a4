// Contact of a soft body in a box of cells with the ground in real time, as constraints on points of its
// surface. Nodes of the box are not on the surface. A contact that measures its gap at the surface and pushes
// a node does work that no energy accounts for, and a ball would bounce higher each time.
#pragma once

#include <vector>

#include "engine/material/contact/body_contacts.h"
#include "engine/scene/loads.h"
#include "engine/simulation/body_contact.h"

namespace spoonbill {

// Returns whether the body touches the ground with samples of its surface. BodyGroundContact has the contacts
// of all other deformable bodies.
bool has_sampled_ground_contact(const BodyState& body, bool is_real_time);

// Owned by the simulation, which rebuilds it when the mapping of the body is replaced. add_contacts()
// allocates nothing.
class SampledGroundContact {
 public:
  explicit SampledGroundContact(const BodyState& body);

  // Adds a constraint for each sample that can reach the ground in the coming tick of `time_s`. Returns false
  // if `contacts` is full.
  bool add_contacts(const IndexedBody& body, const Ground& ground, const Vector3& gravity_m_per_s2,
                    double time_s, BodyContacts& contacts);

 private:
  std::vector<int> samples_;      // samples of the mapping, at most one in each eighth of a cell
  std::vector<float> heights_m_;  // of the nodes above the ground; empty for other bodies
};

}  // namespace spoonbill
