// What moves a lattice whose material is too stiff for its springs to be stepped: a coarser block of
// hexahedra inside it, which the lattice's nodes follow. What draws, touches and holds the body sees the
// lattice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/material/implicit/implicit_body.h"
#include "engine/material/spring_lattice.h"

namespace spoonbill {

// Nodes of the block: what a tick can hold. Hexahedra need few of them, since each can bend.
inline constexpr int implicit_node_budget = 500;

// A node of one grid as a weighted sum of another's.
struct GridPoint {
  std::array<int, 8> node{};
  std::array<double, 8> weight{};
};

// Contacts push the lattice's nodes as if they were a light, free body's; what they pushed acts on the block
// in the next tick. So a tool meets the body where it was a tick ago, and no contact enters the block's
// equations. One owner, the body; built outside the tick, allocates nothing afterwards.
class ImplicitCore {
 public:
  // Unstrained where the lattice's nodes are at `rest_m`.
  static Result<ImplicitCore> make(const LatticeMesh& mesh, const std::vector<Vector3>& rest_m,
                                   const Material& material, InstructionSet set);

  const LatticeMesh& mesh() const { return body_.mesh(); }
  const std::vector<Vector3>& rest_m() const { return rest_m_; }
  // What an impulse on a node of the lattice gives it of velocity in contacts, 1/kg.
  double contact_inverse_mass() const { return contact_inverse_mass_; }

  // One byte a node of the lattice, 1 = held.
  void hold(std::span<const std::uint8_t> held);
  // Takes displacements and velocities from the lattice; the impulses of contacts are forgotten.
  void take_shape(const SpringLattice& lattice);

  // Nodes that something else has moved for good keep their new places beside the block.
  void take_moved_nodes(const SpringLattice& lattice);

  // Steps the block and takes the lattice along.
  ImplicitReport step(const ImplicitStep& step, SpringLattice& lattice);
  // What contacts have changed of the lattice's velocities since acts in the next step.
  void take_contacts(const SpringLattice& lattice);

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    body_.visit_state(visit);
    visit(impulse_.data(), impulse_.size());
    for (const Vector3& rest : rest_m_) visit(rest.data(), 3);
  }

 private:
  explicit ImplicitCore(ImplicitBody body) : body_(std::move(body)) {}
  template <class Of>
  Vector3 sum_over(const GridPoint& follower, const Of& of) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t c = 0; c < 8; ++c) sum += follower.weight[c] * of(follower.node[c]);
    return sum;
  }

  ImplicitBody body_;
  std::vector<Vector3> rest_m_;       // of the lattice's nodes
  std::vector<GridPoint> followers_;  // by node of the lattice
  std::vector<int> nearest_;          // by node of the block: the lattice's node nearest to it in the grid
  std::vector<std::array<float, 3>> velocity_;  // of the lattice's nodes, as the step left them
  std::vector<double> impulse_;                 // by coordinate of the block, N s
  double contact_inverse_mass_ = 0.0;
};

}  // namespace spoonbill
