// Provides a snapshot for pictures, made without simulation: a handle-like tube, straight or bent, with a
// lattice, a fixing plane, a sphere on its free end, and a force.
#pragma once

#include <memory>
#include <string>

#include "engine/collision/stages/contact_stages.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

struct SampleSceneOptions {
  double bend_rad = 0.0;  // angle by which the free end is bent down
  std::string material = "modelling-clay";
  int along = 60, across = 8, through = 4;  // numbers of lattice nodes along x, z and y
};

inline constexpr int sample_width_px = 640, sample_height_px = 360;

// Returns the snapshot of a handle of 100 x 12 x 5 mm: its lower side is at y = 0, its axis is along x, and
// its first third is fixed.
Snapshot sample_scene(const SampleSceneOptions& options = {});

// Returns the stages of the contact between the scene's sphere and its tube.
std::shared_ptr<const ContactStages> sample_stages(const Snapshot& snapshot);

}  // namespace spoonbill
