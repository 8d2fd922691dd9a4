// Refinements of knots, in two steps: prepare_refinement() takes milliseconds and may run on another thread,
// adopt_refinement() takes place between two ticks. Private to engine/simulation.
#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/scene/scene.h"
#include "engine/simulation/scene_contacts.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {

// A refined mapping of one body with all that depends on its samples.
struct PreparedRefinement {
  int body = 0;
  BodyMapping finer;
  SceneContacts contacts;
  std::vector<int> new_sample;  // new index of each sample of the coarser mapping
  Surface surface;              // memory for the scene's surface
};

// Properties of a scene on which a refinement depends, besides the bodies.
struct RefinementScene {
  ContactScene contacts;
  const std::vector<FixingPlane>& planes;
  const ToolModel& model;
};

// Prepares a refinement. Without ranges, it halves the elements at the body's last residual. Otherwise it
// depends only on what stays the same between two changes of the build. Refuses a body with a mesh, a body
// that is not behind its lattice if the ranges are missing, and too large nets. The bodies are as before when
// it returns.
Result<PreparedRefinement> prepare_refinement(const RefineKnots& command, std::vector<BodyState>& bodies,
                                              const RefinementScene& scene);

// Replaces the body's mapping and the contacts, and leaves the replaced ones in `prepared`. The tool keeps
// its grip and its pushes. Allocates nothing.
void adopt_refinement(Simulation::State& state, PreparedRefinement& prepared);

}  // namespace spoonbill
