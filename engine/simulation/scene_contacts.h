// All contacts of a simulation: of its bodies with the tools, each other, themselves and the ground.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/material/contact/body_contacts.h"
#include "engine/simulation/body_contact.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/ground_contact.h"
#include "engine/simulation/rigid_ground_contact.h"
#include "engine/simulation/sampled_ground_contact.h"
#include "engine/simulation/searched_shapes.h"
#include "engine/simulation/tool_contact.h"

namespace spoonbill {

// Properties of a scene on which its contacts depend, besides the bodies and the tool.
struct ContactScene {
  std::size_t body_count = 0;  // bodies of the scene; a soft tool follows them in the list of bodies
  bool has_ground = false;
};

// Contacts without forces. They depend on what stays the same between two changes of the build or of the
// tool's model, so another thread may make them. They store addresses of grids, which each mapping holds by a
// shared pointer, and no addresses of bodies.
struct SceneContacts {
  ToolContact tool, mirrored;
  BodyContacts between;
  std::vector<BodyPairContact> pairs;                // all pairs: (0, 1), (0, 2), (1, 2), ...
  std::vector<BodySelfContact> self;                 // self-contact of each body
  SearchedShapes searched;                           // the shapes for which `between` was found
  BodyGroundContact ground;                          // contacts of the scene's bodies; empty without a ground
  std::vector<RigidGroundContact> rigid_ground;      // contacts of each of the scene's bodies
  std::vector<SampledGroundContact> sampled_ground;  // of each of them, for soft bodies in boxes of cells
};
SceneContacts make_scene_contacts(const std::vector<BodyState>& bodies, const ContactScene& scene,
                                  const ToolModel& model);

}  // namespace spoonbill
