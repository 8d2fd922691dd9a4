// Keeps a body in the scene during a tick. Keeps the pose of a body that nothing fixes. If the lattice of a
// body becomes unstable, restores the shape that the body had at the start of the tick. Owned by the body.
// Allocates only in its constructor.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/implicit/implicit_solver.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

class BodyHold {
 public:
  explicit BodyHold(int nodes);

  // Stores the displacements and the mean pose at the start of a tick.
  void begin(const SpringLattice& lattice);

  // Returns false if the positions and velocities of all nodes are finite and no node is farther than
  // `reach_m` from the centre of mass. Otherwise restores the displacements at the start of the tick, with
  // zero velocities, and returns true. `solver` is null if the body uses the spring solver.
  bool limit(SpringLattice& lattice, ImplicitSolver* solver, double reach_m) const;

  // Returns the body to its mean position and orientation at the start of the tick, and removes its linear
  // and angular momentum, as if a hand gently held the whole body. The lattice must have no fixed nodes. The
  // mean orientation is the rotation that fits the rest shape best (Kabsch 1976), so that it does not drift
  // with a sequence of deformations.
  void keep_pose(SpringLattice& lattice, ImplicitSolver* solver) const;

 private:
  struct MeanPose {
    Vector3 centre_m = Vector3::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    bool has_turn = false;  // false if the body extends in one direction only
  };
  static MeanPose measure(const SpringLattice& lattice);

  std::vector<Vector3> displacements_m_;
  MeanPose pose_;
};

}  // namespace spoonbill
