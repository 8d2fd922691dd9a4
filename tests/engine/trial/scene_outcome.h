// Trials of scenes of random bodies. Whatever happens, the result must be finite, whole and without bodies
// inside each other, and the bodies must not gain energy.
#pragma once

#include <string>

#include "tests/engine/trial/random_scene.h"

namespace spoonbill {

// The result of a trial of a scene.
struct SceneOutcome {
  std::string stopped;  // what stopped the trial; empty if nothing did
  // Largest gain of energy over what gravity and the dish gave the bodies.
  double energy_gain = 0.0;
  double largest_overlap_cells = 0.0, last_overlap_cells = 0.0;
  int inverted_cells = 0;
  bool finite = true;
};

// Runs a scene for so many ticks. The dish is shaken from 0.3 s to 0.7 s.
SceneOutcome run_scene(const RandomScene& random, int ticks);

// Expects that nothing but a stop is wrong with an outcome.
void expect_whole(const SceneOutcome& outcome);

}  // namespace spoonbill
