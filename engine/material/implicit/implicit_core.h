// What moves a lattice whose material is too stiff for its springs to be stepped: a coarser block of
// hexahedra inside it, which the lattice's nodes follow. What draws, touches and holds the body sees the
// lattice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/material/implicit/block_on_ground.h"
#include "engine/material/implicit/grid_point.h"
#include "engine/material/implicit/implicit_body.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Nodes of the block: what a tick can hold of a long body, whose band is narrow; fat ones get fewer.
// Hexahedra need few of them, since each can bend.
inline constexpr int implicit_node_budget = 500;

// Contacts push the lattice's nodes as if each were free, and as light as makes all of them together answer
// as the block did when it was last pushed; the block then answers as a whole. The ground comes last, and
// pushes the block itself. One owner, the body; built outside the tick, allocates nothing afterwards.
class ImplicitCore {
 public:
  // Unstrained where the lattice's nodes are at `rest_m`.
  static Result<ImplicitCore> make(const LatticeMesh& mesh, const std::vector<Vector3>& rest_m,
                                   const LatticeMaterials& materials, InstructionSet set);

  const LatticeMesh& mesh() const { return body_.mesh(); }
  const LatticeReport& report() const { return body_.report(); }
  const std::vector<Vector3>& rest_m() const { return rest_m_; }
  // What an impulse on a node of the lattice gives it of velocity in contacts, 1/kg.
  double contact_inverse_mass() const { return contact_inverse_mass_; }

  // One byte a node of the lattice, 1 = held: holds each node of the block whose nearest one of the lattice
  // is held, and for those that then follow nothing held, what they follow most.
  void hold(std::span<const std::uint8_t> held);
  // Takes displacements and velocities from the lattice.
  void take_shape(const SpringLattice& lattice);

  // Nodes that something else has moved for good keep their new places beside the block.
  void take_moved_nodes(const SpringLattice& lattice);

  // Of the block's velocities, (v.Kv) / (v.Mv); 0 at rest.
  double rayleigh_quotient() { return body_.rayleigh_quotient(); }
  // Takes the forces on these nodes of the lattice, N, instead of all that it had; held nodes bear their own.
  void take_node_forces(const SpringLattice& lattice, std::span<const int> nodes);
  // What follows these held nodes of the lattice, which are in order, moves at this velocity in the coming
  // step.
  void move_held(std::span<const int> nodes, const Vector3& velocity_m_per_s);
  // The force on them and on what follows them as the last step began, N: of the cells, of loads and of
  // gravity.
  Vector3 force_on_held(const SpringLattice& lattice, std::span<const int> nodes,
                        const Vector3& gravity_m_per_s2) const;

  // The lattice's velocities at the end of a step without contacts, but for what the ground did in the last
  // tick to those that are here; contacts then change them.
  ImplicitReport begin_step(const ImplicitStep& step, SpringLattice& lattice,
                            std::span<GroundContact> on_ground = {});
  // Gives the block what contacts changed, lets the ground push it, and takes the lattice along.
  struct OnGround {
    const GroundContacts* ground = nullptr;
    std::span<GroundContact> contacts;
    double push_speed_cap_m_per_s = 0.0;
  };
  void end_step(SpringLattice& lattice, const OnGround& on_ground);

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    body_.visit_state(visit);
    visit(&contact_inverse_mass_, 1);
    for (const Vector3& rest : rest_m_) visit(rest.data(), 3);
  }
  // And on a ground.
  template <class Visitor>
  void visit_state_on_ground(Visitor&& visit) const {
    on_ground_.visit_state(visit);
  }

 private:
  ImplicitCore(ImplicitBody body, int nodes, double mass_kg);
  void write_velocities(SpringLattice& lattice);
  double take_impulses(const SpringLattice& lattice);
  void take_lightness(double answered, SpringLattice& lattice);
  bool follows_held(const GridPoint& follower) const;
  // Of a node of the block.
  bool is_held_by(int node, std::span<const int> nodes) const;

  ImplicitBody body_;
  std::vector<Vector3> rest_m_;       // of the lattice's nodes
  std::vector<GridPoint> followers_;  // by node of the lattice
  std::vector<int> nearest_;          // by node of the block: the lattice's node nearest to it in the grid
  std::vector<int> holder_;  // by node of the block: the held one of the lattice that holds it, or -1
  std::vector<std::array<float, 3>> velocity_;  // of the lattice's nodes, before contacts
  std::vector<double> impulse_;                 // by coordinate of the block, N s: working memory
  BlockOnGround on_ground_;
  double step_s_ = 0.0;
  double contact_inverse_mass_ = 0.0, least_inverse_mass_ = 0.0;
};

}  // namespace spoonbill
