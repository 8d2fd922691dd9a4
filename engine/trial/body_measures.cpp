#include "engine/trial/body_measures.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "engine/inspection/mass_properties.h"

namespace spoonbill {

CellShapes measure_cells(const SpringLattice& lattice) {
  const LatticeMesh& rest = lattice.mesh();
  LatticeMesh bent = rest;
  bent.nodes = lattice.positions();
  CellShapes shape;
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

RigidMass find_fixed_mass(const Body& body) {
  const std::optional<BodyMass> mass = compute_body_mass(body);
  RigidMass found;
  if (mass) {
    found.mass_kg = mass->mass_kg();
    found.centre_m = mass->centre_m;
  } else if (!body.mesh) {
    found.centre_m = compute_enclosed_mass(body.surface).area_centre_m;
  }
  return found;
}

Vector3 find_load_force_n(const SpringLattice& lattice) {
  Vector3 sum = Vector3::Zero();
  if (!lattice.has_applied_force()) return sum;
  for (int axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < lattice.mesh().node_count(); ++n) {
      sum[axis] += static_cast<double>(lattice.applied_force(axis)[n]);
    }
  }
  return sum;
}

bool EnergyMeter::has_cells_of(const SpringLattice& lattice) const {
  const auto responds_alike = [](const Material& one, const Material& other) {
    return one.youngs_modulus_pa == other.youngs_modulus_pa && one.poissons_ratio == other.poissons_ratio;
  };
  return cells_ && cells_->mesh().count == lattice.mesh().count &&
         cells_->mesh().nodes == lattice.mesh().nodes &&
         std::equal(materials_.begin(), materials_.end(), lattice.materials().materials.begin(),
                    lattice.materials().materials.end(), responds_alike);
}

std::optional<double> EnergyMeter::find_energy_j(const SpringLattice& lattice,
                                                 const Vector3& gravity_m_per_s2) {
  if (!are_linear_elastic(lattice.materials())) return std::nullopt;
  if (!has_cells_of(lattice)) {
    const CellKind kind =
        min_poissons_ratio(lattice.materials()) >= min_spring_poissons_ratio && !lattice.moved_by_solver()
            ? CellKind::springs
            : CellKind::hexahedra;
    Result<StaticBody> cells = StaticBody::make(lattice.mesh(), lattice.materials(), kind);
    if (!cells.ok()) return std::nullopt;
    cells_ = std::move(cells).value();
    materials_ = lattice.materials().materials;
  }
  double energy_j = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto mass = static_cast<double>(lattice.mass(n));
    energy_j += mass * (0.5 * lattice.velocity(n).squaredNorm() - gravity_m_per_s2.dot(lattice.position(n)));
  }
  for (std::size_t cell = 0; cell < cells_->cell_count(); ++cell) {
    CellMoves moves;
    for (std::size_t c = 0; c < 8; ++c) moves[c] = lattice.displacement(cells_->cell_nodes(cell)[c]);
    energy_j += cells_->energy_j(cell, moves);
  }
  return energy_j;
}

}  // namespace spoonbill
