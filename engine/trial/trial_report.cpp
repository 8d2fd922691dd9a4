#include "engine/trial/trial_report.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/inspection/mass_properties.h"
#include "engine/material/statics/static_body.h"
#include "engine/simulation/body_hold.h"

namespace spoonbill {
namespace {

struct CellShape {
  double smallest_jacobian = 1.0;
  int inverted_cells = 0;
};

CellShape measure_cells(const SpringLattice& lattice) {
  const LatticeMesh& rest = lattice.mesh();
  LatticeMesh bent = rest;
  bent.nodes = lattice.positions();
  CellShape shape;
  for (int i = 0; i + 1 < rest.count[0]; ++i) {
    for (int j = 0; j + 1 < rest.count[1]; ++j) {
      for (int k = 0; k + 1 < rest.count[2]; ++k) {
        if (!rest.is_filled(i, j, k)) continue;
        const CellCorners before = rest.cell(i, j, k), after = bent.cell(i, j, k);
        double smallest = infinity;
        for (int corner = 0; corner < 8; ++corner) {
          const Vector3 at(corner >> 2 & 1, corner >> 1 & 1, corner & 1);
          smallest = std::min(smallest, trilinear_jacobian(after, at.x(), at.y(), at.z()).determinant() /
                                            trilinear_jacobian(before, at.x(), at.y(), at.z()).determinant());
        }
        shape.smallest_jacobian = std::min(shape.smallest_jacobian, smallest);
        if (smallest <= 0.0) ++shape.inverted_cells;
      }
    }
  }
  return shape;
}

Vector3 find_loads_n(const SpringLattice& lattice) {
  Vector3 sum = Vector3::Zero();
  if (!lattice.has_applied_force()) return sum;
  for (int axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      sum[axis] += static_cast<double>(lattice.applied_force(axis)[n]);
    }
  }
  return sum;
}

struct RigidMass {
  double mass_kg = 0.0;
  Vector3 centre_m = Vector3::Zero();
};

// Returns the mass and the centre of mass of a fixed body. If its mass cannot be computed, the mass is 0 and
// the centre is that of its area.
RigidMass find_rigid_mass(const Body& body, const Surface& surface) {
  Body present = body;
  present.surface = surface;
  const std::optional<BodyMass> mass = compute_body_mass(present);
  RigidMass found;
  if (mass) {
    found.mass_kg = mass->mass_kg();
    found.centre_m = mass->centre_m;
  } else {
    found.centre_m = compute_enclosed_mass(surface).area_centre_m;
  }
  return found;
}

std::optional<double> find_energy_j(const SpringLattice& lattice, const Vector3& gravity_m_per_s2) {
  if (!are_linear_elastic(lattice.materials())) return std::nullopt;
  const CellKind kind =
      min_poissons_ratio(lattice.materials()) >= min_spring_poissons_ratio && !lattice.moved_by_solver()
          ? CellKind::springs
          : CellKind::hexahedra;
  const Result<StaticBody> cells = StaticBody::make(lattice.mesh(), lattice.materials(), kind);
  if (!cells.ok()) return std::nullopt;
  double energy_j = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto mass = static_cast<double>(lattice.mass(n));
    energy_j += mass * (0.5 * lattice.velocity(n).squaredNorm() - gravity_m_per_s2.dot(lattice.position(n)));
  }
  for (std::size_t cell = 0; cell < cells->cell_count(); ++cell) {
    CellMoves moves;
    for (std::size_t c = 0; c < 8; ++c) moves[c] = lattice.displacement(cells->cell_nodes(cell)[c]);
    energy_j += cells->energy_j(cell, moves);
  }
  return energy_j;
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
  Vector3 others_n = mean.ground_n + mean.contact_n - mean.inertial_n;
  double mass_kg = lattice.mass_kg();
  if (body.kind == BodyKind::fixed) {
    const RigidMass rigid = find_rigid_mass(body, simulation.surface(number));
    report.centre_of_mass_m = rigid.centre_m;
    mass_kg = rigid.mass_kg;
  } else {
    const CellShape cells = measure_cells(lattice);
    report.centre_of_mass_m = find_mass_centre(lattice).position_m;
    report.volume_ratio = lattice.volume_m3() / lattice.rest_volume_m3();
    report.smallest_jacobian = cells.smallest_jacobian;
    report.inverted_cells = cells.inverted_cells;
    others_n += find_loads_n(lattice);
  }
  report.support_force_n = -others_n - mass_kg * simulation.scene().sculpting.gravity_m_per_s2;
  return report;
}

// Returns whether anything but contacts and the ground can hold a body.
bool is_held(const Simulation& simulation, std::size_t index) {
  return simulation.scene().bodies[index].kind == BodyKind::fixed ||
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
    report.inertia_scale = std::max(report.inertia_scale, simulation.inertia_scale(static_cast<int>(b)));
    const std::optional<double> energy_j = find_energy_j(simulation.lattice(static_cast<int>(b)), gravity);
    report.energy_j =
        energy_j && report.energy_j ? std::optional(*report.energy_j + *energy_j) : std::nullopt;
  }
  return report;
}

}  // namespace spoonbill
