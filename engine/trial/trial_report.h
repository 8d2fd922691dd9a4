// The report of a trial about its bodies. Computed outside the tick.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/spill.h"
#include "engine/trial/trial.h"

namespace spoonbill {

struct TrialBodyReport {
  std::string name;
  Vector3 centre_of_mass_m = Vector3::Zero();
  // volume_ratio and smallest_jacobian compare a lattice with its rest shape; both are 1 for any other body.
  // The Jacobian is the least volume at a corner of a cell, divided by its value at rest.
  double volume_ratio = 1.0;
  double smallest_jacobian = 1.0;
  int inverted_cells = 0;  // cells with a corner whose volume is not positive
  bool is_gone = false;    // Simulation::is_gone()
  // Radius of a circle of the area on which contacts, taken together, pushed in the last tick, and the
  // smallest radius that the cells resolve (find_smallest_contact_radius_m()), m; 0 for any other body.
  double contact_radius_m = 0.0, smallest_contact_radius_m = 0.0;
  // Mean forces on the body over the last half second: of planes, supports and whatever else holds the body;
  // of the ground; and of other bodies. The first is the rest of Newton's second law after weight, loads,
  // ground and contacts. For a fixed body without a computable mass, it does not include the weight.
  Vector3 support_force_n = Vector3::Zero();
  Vector3 ground_force_n = Vector3::Zero();
  Vector3 contact_force_n = Vector3::Zero();
  std::optional<Spill> spill;  // empty if the body has not been inside a rim
};

// Returns whether the body has contacts, and they are too small for its cells, so that their force and depth
// are not reliable.
inline bool has_small_contact(const TrialBodyReport& body) {
  return body.contact_radius_m > 0.0 && body.contact_radius_m < body.smallest_contact_radius_m;
}

struct TrialReport {
  std::vector<TrialBodyReport> bodies;
  int inverted_cells = 0;
  double inertia_scale = 1.0;  // largest of all bodies; 1 unless the scene is not a trial
  // Kinetic, gravitational and elastic energy of the deformable and rigid bodies, J. Empty if a material is
  // plastic or creeps, because its elastic energy is then not a function of the shape.
  std::optional<double> energy_j;
};

TrialReport report_on(const Trial& trial, const Simulation& simulation);

}  // namespace spoonbill
