#include "engine/simulation/body_hold.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {
namespace {

// A body's orientation is defined only if its second largest extent is at least this fraction of its largest
// one. The extents are the singular values in BodyHold::measure().
constexpr double least_second_extent = 1e-6;
// Largest turn of an intact body in a tick, rad. A larger turn means that the shape has lost its orientation,
// for instance by turning inside out. Such a turn is not undone.
constexpr double largest_turn_rad = 0.2;
// If the displacement and the turn in a tick are both below these values, they are not corrected. A body at
// rest therefore stays bitwise the same.
constexpr double least_move_m = 1e-9, least_turn_rad = 1e-8;

}  // namespace

MassCentre find_mass_centre(const SpringLattice& lattice) {
  MassCentre centre;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto mass = static_cast<double>(lattice.mass(n));
    centre.mass_kg += mass;
    centre.rest_m += mass * lattice.mesh().nodes[static_cast<std::size_t>(n)];
    centre.position_m += mass * lattice.position(n);
    centre.velocity_m_per_s += mass * lattice.velocity(n);
  }
  SPOONBILL_ASSERT_DEBUG(centre.mass_kg > 0.0);
  centre.rest_m /= centre.mass_kg;
  centre.position_m /= centre.mass_kg;
  centre.velocity_m_per_s /= centre.mass_kg;
  return centre;
}

namespace {

// Returns the angular velocity of a rigid body with the mass distribution and angular momentum of the
// lattice, rad/s.
Vector3 find_spin(const SpringLattice& lattice, const MassCentre& centre) {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vector3 momentum = Vector3::Zero();
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto mass = static_cast<double>(lattice.mass(n));
    const Vector3 arm = lattice.position(n) - centre.position_m;
    inertia += mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    momentum += mass * arm.cross(lattice.velocity(n));
  }
  const double size = inertia.trace();
  if (!(size > 0.0)) return Vector3::Zero();
  // The added term keeps the tensor invertible for a rod, which does not resist a spin about its axis.
  inertia += 1e-9 * size * Eigen::Matrix3d::Identity();
  return solve_symmetric(inertia, momentum);
}

}  // namespace

BodyHold::BodyHold(const SpringLattice& lattice) {
  const auto nodes = static_cast<std::size_t>(lattice.mesh().node_count());
  SPOONBILL_ASSERT(nodes > 0);
  for (std::vector<float>& displacements : displacements_m_) displacements.assign(nodes, 0.0f);
  const MassCentre centre = find_mass_centre(lattice);
  mass_kg_ = centre.mass_kg;
  rest_centre_m_ = centre.rest_m;
  for (const Vector3& node : lattice.mesh().nodes) {
    rest_radius_m_ = std::max(rest_radius_m_, (node - rest_centre_m_).norm());
  }
}

BodyHold::MeanPose BodyHold::measure(const SpringLattice& lattice) const {
  const int nodes = lattice.mesh().node_count();
  Vector3 centre = Vector3::Zero();
  for (int n = 0; n < nodes; ++n) centre += static_cast<double>(lattice.mass(n)) * lattice.position(n);
  centre /= mass_kg_;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (int n = 0; n < nodes; ++n) {
    const Vector3 rest = lattice.mesh().nodes[static_cast<std::size_t>(n)] - rest_centre_m_;
    moments += static_cast<double>(lattice.mass(n)) * (lattice.position(n) - centre) * rest.transpose();
  }
  MeanPose pose;
  pose.centre_m = centre;
  if (!moments.allFinite()) return pose;
  const SingularValues parts = decompose_singular(moments);
  const double sign = (parts.left * parts.right.transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Vector3 extents = parts.values;
  pose.has_turn = extents[1] + sign * extents[2] > least_second_extent * extents[0];
  pose.turn = parts.left * Vector3(1.0, 1.0, sign).asDiagonal() * parts.right.transpose();
  return pose;
}

void BodyHold::begin(const SpringLattice& lattice, bool may_keep_pose) {
  const auto nodes = static_cast<std::size_t>(lattice.mesh().node_count());
  for (int axis = 0; axis < 3; ++axis) {
    SPOONBILL_ASSERT(displacements_m_[axis].size() == nodes);
    std::copy_n(lattice.displacements(axis), nodes, displacements_m_[axis].begin());
  }
  if (may_keep_pose && !lattice.has_fixed_nodes()) pose_ = measure(lattice);
}

bool BodyHold::is_surely_in_reach(const SpringLattice& lattice, double reach_m) const {
  const int nodes = lattice.mesh().node_count();
  Vector3 spread_m;
  for (int axis = 0; axis < 3; ++axis) {
    const FieldRange moves = lattice.kernels().find_range(lattice.displacements(axis), nodes);
    const FieldRange velocities = lattice.kernels().find_range(lattice.velocities(axis), nodes);
    if (!moves.has_finite_sum || !velocities.has_finite_sum) return false;
    spread_m[axis] = static_cast<double>(moves.high) - static_cast<double>(moves.low);
  }
  // The displacement of the centre of mass is a mean of the nodes' displacements. It therefore differs from
  // each of them by no more than the diagonal of their box.
  constexpr double rounding = 1e-6;
  return rest_radius_m_ + spread_m.norm() < (1.0 - rounding) * reach_m;
}

bool BodyHold::limit(SpringLattice& lattice, ImplicitSolver* solver, double reach_m) const {
  SPOONBILL_ASSERT_DEBUG(reach_m > 0.0);
  if (is_surely_in_reach(lattice, reach_m)) return false;
  const Vector3 centre = find_mass_centre(lattice).position_m;
  bool follows = centre.allFinite();
  for (int n = 0; n < lattice.mesh().node_count() && follows; ++n) {
    follows =
        (lattice.position(n) - centre).squaredNorm() <= reach_m * reach_m && lattice.velocity(n).allFinite();
  }
  if (follows) return false;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    lattice.set_displacement(n, {displacements_m_[0][at], displacements_m_[1][at], displacements_m_[2][at]});
    lattice.set_velocity(n, Vector3::Zero());
  }
  if (solver != nullptr) solver->adopt_shape(lattice);
  return true;
}

void BodyHold::keep_pose(SpringLattice& lattice, ImplicitSolver* solver, const Vector3& shift_m) const {
  SPOONBILL_ASSERT_DEBUG(!lattice.has_fixed_nodes());
  const MeanPose now = measure(lattice);
  const bool is_turned = (now.turn - pose_.turn).norm() > least_turn_rad;
  const Vector3 centre_m = pose_.centre_m + shift_m;
  if (!is_turned && (now.centre_m - centre_m).norm() <= least_move_m) return;
  const MassCentre centre = find_mass_centre(lattice);
  RigidMove move;
  move.from_m = now.centre_m;
  move.to_m = centre_m;
  move.velocity_m_per_s = centre.velocity_m_per_s;
  move.spin_rad_per_s = find_spin(lattice, centre);
  if (now.has_turn && pose_.has_turn) {
    const Eigen::Matrix3d back = pose_.turn * now.turn.transpose();
    if (Eigen::AngleAxisd(back).angle() < largest_turn_rad) move.turn = back;
  }
  if (solver != nullptr) return solver->move_rigidly(move, lattice);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.mesh().joined(n) != n) continue;
    const Vector3 position = lattice.position(n), velocity = lattice.velocity(n);
    lattice.set_displacement(n, move.moved(position) - lattice.mesh().nodes[static_cast<std::size_t>(n)]);
    lattice.set_velocity(n, move.slowed(position, velocity));
  }
}

}  // namespace spoonbill
