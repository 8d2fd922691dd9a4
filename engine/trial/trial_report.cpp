#include "engine/trial/trial_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/simulation/body_hold.h"
#include "engine/trial/body_measures.h"

namespace spoonbill {
namespace {

// Returns a fixed body where it is now.
Body find_present_body(const Simulation& simulation, int number) {
  Body present = simulation.scene().bodies[static_cast<std::size_t>(number)];
  if (present.mesh) {
    present.mesh_pose = composed(*simulation.rigid_pose(number), present.mesh_pose);
  } else {
    present.surface = simulation.surface(number);
  }
  return present;
}

TrialBodyReport report_on_body(const Trial& trial, const Simulation& simulation, std::size_t index) {
  const Body& body = simulation.scene().bodies[index];
  const int number = static_cast<int>(index);
  const SpringLattice& lattice = simulation.lattice(number);
  const Trial::MeanForces mean = trial.find_mean_forces(index);
  TrialBodyReport report;
  report.name = body.name;
  report.ground_force_n = mean.ground_n;
  report.contact_force_n = mean.contact_n;
  if (const Spill* const spill = trial.spill(index)) report.spill = *spill;
  Vector3 others_n = mean.ground_n + mean.contact_n - mean.inertial_n;
  double mass_kg = lattice.mass_kg();
  if (const RigidDynamics* const rigid = simulation.rigid_dynamics(number)) {
    report.centre_of_mass_m = rigid->centre_m();
    mass_kg = rigid->mass().mass_kg;
  } else if (body.kind == BodyKind::fixed) {
    const RigidMass fixed = find_fixed_mass(find_present_body(simulation, number));
    report.centre_of_mass_m = fixed.centre_m;
    mass_kg = fixed.mass_kg;
  } else {
    const CellShapes cells = measure_cells(lattice);
    report.centre_of_mass_m = find_mass_centre(lattice).position_m;
    report.volume_ratio = lattice.volume_m3() / lattice.rest_volume_m3();
    report.smallest_jacobian = cells.smallest_jacobian;
    report.is_gone = simulation.is_gone(number);
    report.inverted_cells = cells.inverted_cells;
    report.contact_radius_m = std::sqrt(simulation.contact_area_m2(number) / std::numbers::pi);
    report.smallest_contact_radius_m = simulation.smallest_contact_radius_m(number);
    others_n += find_load_force_n(lattice);
  }
  report.support_force_n = -others_n - mass_kg * simulation.scene().sculpting.gravity_m_per_s2;
  return report;
}

// Returns whether anything but contacts and the ground can hold a body.
bool is_held(const Simulation& simulation, std::size_t index) {
  const Body& body = simulation.scene().bodies[index];
  return body.kind == BodyKind::fixed || body.hand.has_value() ||
         simulation.lattice(static_cast<int>(index)).has_fixed_nodes();
}

}  // namespace

TrialReport report_on(const Trial& trial, const Simulation& simulation) {
  const Vector3& gravity = simulation.scene().sculpting.gravity_m_per_s2;
  TrialReport report;
  report.energy_j = 0.0;
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    report.bodies.push_back(report_on_body(trial, simulation, b));
    if (!is_held(simulation, b)) report.bodies.back().support_force_n.setZero();
    report.inverted_cells += report.bodies.back().inverted_cells;
    if (simulation.scene().bodies[b].kind == BodyKind::fixed) continue;
    if (const RigidDynamics* const rigid = simulation.rigid_dynamics(static_cast<int>(b))) {
      if (report.energy_j) *report.energy_j += rigid->energy_j(gravity);
      continue;
    }
    report.inertia_scale = std::max(report.inertia_scale, simulation.inertia_scale(static_cast<int>(b)));
    const SpringLattice& lattice = simulation.lattice(static_cast<int>(b));
    const std::optional<double> energy_j = EnergyMeter().find_energy_j(lattice, gravity);
    report.energy_j =
        energy_j && report.energy_j ? std::optional(*report.energy_j + *energy_j) : std::nullopt;
  }
  return report;
}

}  // namespace spoonbill
