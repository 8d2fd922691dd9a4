// Trials of a block of gelatin on a fixed plate or in a fixed bowl, for tests of its rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/trial.h"
#include "tests/engine/trial/exact_distance.h"

namespace spoonbill {

// A block of gelatin of 30 x 15 x 24 mm, and what it is laid on.
struct GelatinTrial {
  std::optional<double> bowl_m = {};  // depth of the bowl of 60 x 42 mm; empty: a plate
  double friction = 0.3;
  int node_budget = 500;
  double rounding_m = 0.003;
  double tilt_deg = 0.0;              // about z, after the gelatin has settled
  std::optional<double> fall_m = {};  // height above the bowl or plate from which it falls; empty: lowered
  bool damped = true;
  int step_division = 1;
};
inline constexpr double gelatin_height_m = 0.015;

// Returns a name for the trial's row of a table.
std::string describe(const GelatinTrial& trial);

// Returns the scene. The gelatin is its first body and the bowl or plate its second.
Scene gelatin_scene(const GelatinTrial& trial);

// Finds the mean height of the block's top along y, weighted by the area at rest.
class TopGauge {
 public:
  explicit TopGauge(const Surface& at_rest);
  double find_height_m(const Surface& surface) const;

 private:
  std::vector<double> areas_m2_;  // of the samples of the top; 0 for others
};

// State of a trial once the gelatin has settled, or after ten seconds.
struct GelatinRest {
  std::string stopped;         // what stopped the trial; empty if nothing did
  bool settled = false;        // after the lowering, and after the turn if there is one
  double settled_s = 0.0;      // time from the end of the lowering or of the turn to the rest
  double speed_m_per_s = 0.0;  // largest at the end
  int inverted_cells = 0;
  double smallest_jacobian = 1.0;
  double depth_m = 0.0;  // of the skin in the bowl or plate
  double cell_m = 0.0;
  int nodes = 0;
  Vector3 centre_m = Vector3::Zero(), nodes_mean_m = Vector3::Zero();
  Vector3 moved_m = Vector3::Zero();  // by the centre of mass since the turn or, without one, the start
  Vector3 force_n = Vector3::Zero();  // of the gelatin on the bowl or plate, mean of half a second
  double sag_m = 0.0;  // drop of the top's mean from where the undeformed block would touch, before a turn
  double weight_n = 0.0;
};

// Runs the trial for ten seconds before and after the turn, or until half a second after the gelatin has
// settled.
GelatinRest run_gelatin(const GelatinTrial& trial);

// Returns the distance of the present skin of the gelatin, which must not touch, from the bowl or plate along
// gravity.
double find_gelatin_gap_m(const Scene& scene);

}  // namespace spoonbill
