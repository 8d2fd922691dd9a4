// Keeps a body in the scene during a tick. Keeps the pose of a body that nothing fixes. If the lattice of a
// body becomes unstable, restores the shape that the body had at the start of the tick. Owned by the body.
// Allocates only when it is made.
#pragma once

#include <array>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/implicit/implicit_solver.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Mass of a lattice, and the centre of mass with its position at rest and at present, and its velocity.
struct MassCentre {
  Vector3 rest_m = Vector3::Zero(), position_m = Vector3::Zero(), velocity_m_per_s = Vector3::Zero();
  double mass_kg = 0.0;

  Vector3 momentum_ns() const { return mass_kg * velocity_m_per_s; }
};
MassCentre find_mass_centre(const SpringLattice& lattice);

class BodyHold {
 public:
  // Makes the hold of a body with this lattice. If its masses or rest positions change, a new hold must be
  // made.
  explicit BodyHold(const SpringLattice& lattice);

  // Stores the displacements and, if keep_pose() may be called, the mean pose at the start of a tick.
  void begin(const SpringLattice& lattice, bool may_keep_pose = true);

  // Returns false if the positions and velocities of all nodes are finite and no node is farther than
  // `reach_m` from the centre of mass. Otherwise restores the displacements at the start of the tick, with
  // zero velocities, and returns true. `solver` is null if the body uses the spring solver.
  bool limit(SpringLattice& lattice, ImplicitSolver* solver, double reach_m) const;

  // Returns the body to its mean orientation at the start of the tick, and to its mean position plus
  // `shift_m`, and removes its linear and angular momentum, as if a hand gently held the whole body. The
  // lattice must have no fixed nodes. The mean orientation is the rotation that fits the rest shape best
  // (Kabsch 1976), so that it does not drift with a sequence of deformations.
  void keep_pose(SpringLattice& lattice, ImplicitSolver* solver,
                 const Vector3& shift_m = Vector3::Zero()) const;

 private:
  struct MeanPose {
    Vector3 centre_m = Vector3::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    bool has_turn = false;  // false if the body extends in one direction only
  };
  MeanPose measure(const SpringLattice& lattice) const;
  // Returns true if all velocities are finite and the displacements differ so little that no node can be
  // farther than `reach_m` from the centre of mass. This is the usual case and takes little time.
  bool is_surely_in_reach(const SpringLattice& lattice, double reach_m) const;

  std::array<std::vector<float>, 3> displacements_m_;  // at the start of the tick, by axis
  double mass_kg_ = 0.0;
  Vector3 rest_centre_m_ = Vector3::Zero();  // centre of mass in the rest shape
  double rest_radius_m_ = 0.0;  // largest distance of a node from the centre of mass in the rest shape
  MeanPose pose_;
};

}  // namespace spoonbill
