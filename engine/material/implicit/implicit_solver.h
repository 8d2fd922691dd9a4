// Implicit solver of a lattice whose material is too stiff for the explicit spring solver.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/contact/ground_contacts.h"
#include "engine/material/implicit/grid_point.h"
#include "engine/material/implicit/implicit_body.h"
#include "engine/material/implicit/implicit_ground_contacts.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Node budget of the coarse grid of hexahedra in an implicit solver: as many nodes as a tick can solve for a
// long body, whose matrix has a narrow band. Compact bodies get fewer nodes. A body needs few hexahedra,
// since each can bend.
inline constexpr int implicit_node_budget = 500;

// An instantaneous rigid displacement of a body, which also subtracts a rigid motion from the body's
// velocities.
struct RigidMove {
  Vector3 from_m = Vector3::Zero(), to_m = Vector3::Zero();  // centre before and after the move
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();        // rotation about the centre
  // Rigid motion that is subtracted from the velocities before the rotation.
  Vector3 velocity_m_per_s = Vector3::Zero(), spin_rad_per_s = Vector3::Zero();

  Vector3 moved(const Vector3& position_m) const { return to_m + turn * (position_m - from_m); }
  // Returns the new velocity of a point that was at `position_m` and had the velocity `before`.
  Vector3 slowed(const Vector3& position_m, const Vector3& before) const {
    return turn * (before - velocity_m_per_s - spin_rad_per_s.cross(position_m - from_m));
  }
};

// Implicit solver of a lattice: a coarser block of hexahedra, whose motion the lattice's nodes follow.
// Drawing, contacts and supports use the lattice.
//
// Contacts push the lattice's nodes as if each were free, with an inverse mass that matches the block's
// response to the last contacts. The block then responds as a whole, after each pass over the contacts with
// other such blocks and at the end of the step. If the block responds more than the contacts assumed, the
// impulses of the pass are scaled down. The contacts with the ground are solved last and push the block
// directly.
//
// Owned by the body. It is built outside the tick and allocates nothing afterwards.
class ImplicitSolver {
 public:
  // Builds the solver of a lattice. The solver's block is unstrained when the lattice's nodes are at
  // `rest_m`.
  static Result<ImplicitSolver> make(const LatticeMesh& mesh, const std::vector<Vector3>& rest_m,
                                     const LatticeMaterials& materials, InstructionSet set);

  const LatticeMesh& mesh() const { return body_.mesh(); }
  const LatticeReport& report() const { return body_.report(); }
  const std::vector<Vector3>& rest_m() const { return rest_m_; }
  // Sets the ratio of the body's inertia to its mass, at least 1. The caller must pass the new
  // contact_inverse_mass() to the lattice.
  void set_inertia_scale(double scale);

  // Velocity change of a lattice node per impulse that contacts assume, 1/kg.
  double contact_inverse_mass() const { return contact_inverse_mass_; }

  // Fixes nodes of the lattice, one byte per node. Each node of the hexahedral block is fixed if the lattice
  // node nearest to it is fixed. A fixed lattice node may still follow only free block nodes. Of these, the
  // node with the largest weight is then fixed, too.
  void fix_nodes(std::span<const std::uint8_t> fixed);
  // Sets the displacements and velocities of the hexahedral block from those of the lattice.
  void adopt_shape(const SpringLattice& lattice);
  // Sets the rest positions of the lattice's nodes to those that rest_m() has returned. adopt_shape() must
  // follow. Allocates nothing.
  void restore_rest(std::span<const Vector3> rest_m);

  // Moves the hexahedral block rigidly, and the lattice that follows it. No node may be fixed.
  void move_rigidly(const RigidMove& move, SpringLattice& lattice);

  // Call after lattice nodes have been moved permanently without the hexahedral block, as by
  // SpringLattice::reform(). Sets the rest positions of free lattice nodes so that the nodes stay where they
  // are when they follow the block.
  void adopt_moved_nodes(const SpringLattice& lattice);

  // Rayleigh quotient (v.Kv) / (v.Mv) of the hexahedral block's velocities; 0 at rest.
  double rayleigh_quotient() { return body_.rayleigh_quotient(); }
  // Replaces all forces on the hexahedral block's nodes by the forces, N, that the lattice has on `nodes`.
  // Forces on fixed nodes are ignored, because they do not move the block.
  void set_node_forces(const SpringLattice& lattice, std::span<const int> nodes);
  // `nodes` are fixed lattice nodes in ascending order; each may fix some nodes of the hexahedral block. Sets
  // the velocity of these block nodes for the coming steps.
  void move_fixed(std::span<const int> nodes, const Vector3& velocity_m_per_s);
  // `nodes` are fixed lattice nodes in ascending order; each may fix some nodes of the hexahedral block.
  // Returns the force of cells, loads and gravity on all these nodes at the start of the last step, N.
  Vector3 force_on_fixed(const SpringLattice& lattice, std::span<const int> nodes,
                         const Vector3& gravity_m_per_s2) const;

  // Adds an impulse on a lattice node to the known impulses of the next step, N s. Known impulses act in
  // full, while impulses that contacts add later may be scaled down.
  void add_known_impulse(const SpringLattice& lattice, int node, const Vector3& impulse_ns);
  // Computes the velocities at the end of a step and sets them in the lattice. The step includes the known
  // impulses and the impulses of the ground contacts in the last tick, but no other contacts. Contacts then
  // change the velocities.
  ImplicitReport begin_step(const ImplicitStep& step, SpringLattice& lattice,
                            std::span<GroundContact> on_ground = {});
  // Work of the contacts' impulses since the last response: `assumed_work_j` with the velocity changes that
  // the contacts assumed, `work_j` with the velocity changes of the hexahedral block.
  struct ContactResponse {
    double assumed_work_j = 0.0, work_j = 0.0;

    // Returns the fraction of the impulses for which the energy is least. It is below 1 if the block responds
    // more than the contacts assumed. `other_work_j` is the work of the impulses on other bodies.
    double find_best_fraction(double other_work_j) const {
      const double assumed = assumed_work_j + other_work_j, work = work_j + other_work_j;
      return work > assumed ? assumed / work : 1.0;
    }
  };
  ContactResponse find_response(const SpringLattice& lattice);
  // Multiplies the response computed by find_response() by `fraction` and applies it to the hexahedral block.
  // Then updates the lattice's velocities.
  void respond(double fraction, SpringLattice& lattice);
  // Ground contacts of the lattice, passed to end_step().
  struct GroundPush {
    const GroundContacts* ground = nullptr;
    std::span<GroundContact> contacts;
    double push_speed_cap_m_per_s = 0.0;
  };
  // Responds to the contacts with other bodies since the last response. If the block responds so much more
  // than the contacts assumed that the bodies would gain energy, the impulses are scaled down to those with
  // the least energy. `assumed_work_of_pairs_j` is BodyContacts::find_assumed_work_j(). Returns the fraction
  // that acts, at most 1.
  double respond_to_pairs(double assumed_work_of_pairs_j, SpringLattice& lattice);
  // Ends a step: moves the block and the lattice.
  void end_step(SpringLattice& lattice, const GroundPush& on_ground);

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    body_.visit_state(visit);
    for (const double* value : {&contact_inverse_mass_, &inertia_scale_}) visit(value, 1);
    for (const Vector3& rest : rest_m_) visit(rest.data(), 3);
  }
  // Visits the additional state of a body on the ground.
  template <class Visitor>
  void visit_state_on_ground(Visitor&& visit) const {
    ground_contacts_.visit_state(visit);
  }

 private:
  ImplicitSolver(ImplicitBody body, int nodes, double mass_kg);
  void write_velocities(SpringLattice& lattice);
  void write_displacements(SpringLattice& lattice);
  double collect_impulses(const SpringLattice& lattice);
  void update_contact_mass(SpringLattice& lattice);
  bool follows_fixed(const GridPoint& follower) const;
  // Returns whether one of the lattice nodes `nodes` fixes this node of the hexahedral block.
  bool is_fixed_by(int node, std::span<const int> nodes) const;

  ImplicitBody body_;
  std::vector<Vector3> rest_m_;        // rest positions of the lattice's nodes
  std::vector<Vector3> first_rest_m_;  // those of make(), where the block is unstrained
  // Each lattice node as a weighted sum of block nodes: at its exact position, and at its grid indices. The
  // latter decides which block nodes a fixed lattice node fixes.
  std::vector<GridPoint> followers_, by_index_;
  std::vector<int> nearest_;      // for each block node: the lattice node nearest in grid coordinates
  std::vector<int> fixing_node_;  // for each block node: lattice node that fixes it, or -1 if none
  // Velocities of the lattice's nodes as last written, before contacts change them.
  std::vector<std::array<float, 3>> velocity_;
  std::vector<double> known_;    // known impulses of the next step, by coordinate of the block, N s
  std::vector<double> impulse_;  // working memory: impulses by coordinate of the block, N s
  ImplicitGroundContacts ground_contacts_;
  double step_s_ = 0.0;
  // Inverse mass measured in the first response of the tick, 1/kg; 0 without a response.
  double measured_inverse_mass_ = 0.0;
  double inertia_scale_ = 1.0;
  double contact_inverse_mass_ = 0.0, min_inverse_mass_ = 0.0;  // 1/kg, with the scaled inertia
};

}  // namespace spoonbill
