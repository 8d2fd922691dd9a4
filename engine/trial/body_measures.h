// Measures of bodies in a simulation: shapes of cells, energy, mass of fixed bodies. Computed outside the
// tick; all functions allocate.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/material/rigid/rigid_mass.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/material/statics/static_body.h"
#include "engine/scene/body.h"

namespace spoonbill {

// The Jacobian of a cell is the least volume at one of its corners, divided by its value at rest. A cell is
// inverted if it is not positive.
struct CellShapes {
  double smallest_jacobian = 1.0;
  int inverted_cells = 0;
};
CellShapes measure_cells(const SpringLattice& lattice);

// Returns the mass and centre of mass of a fixed body, without its inertia. If its mass cannot be computed,
// the mass is 0 and the centre is that of its area.
RigidMass find_fixed_mass(const Body& body);

// Returns the sum of the loads on a body, N.
Vector3 find_load_force_n(const SpringLattice& lattice);

// Finds the kinetic, gravitational and elastic energy of a deformable body. Keeps the body's cells from call
// to call, until its lattice or its material changes. Has one owner, on one thread.
class EnergyMeter {
 public:
  // Returns the energy, J; the gravitational energy is zero at the origin. Empty if a material is plastic or
  // creeps, because the elastic energy is then not a function of the shape.
  std::optional<double> find_energy_j(const SpringLattice& lattice, const Vector3& gravity_m_per_s2);

 private:
  bool has_cells_of(const SpringLattice& lattice) const;

  std::optional<StaticBody> cells_;
  std::vector<Material> materials_;  // those of the cells
};

}  // namespace spoonbill
