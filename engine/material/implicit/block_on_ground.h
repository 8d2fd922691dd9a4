// What the ground gives a body that moves once a tick, by an implicit step: all of its contacts at once.
#pragma once

#include <span>
#include <vector>

#include "engine/material/contact/ground_contacts.h"
#include "engine/material/implicit/grid_point.h"
#include "engine/material/implicit/implicit_body.h"

namespace spoonbill {

// Impulses r on points of the body change their velocities by W r, where W is what the whole body answers.
// Wanted are those that complement the gaps, with Coulomb's friction:
//
//   r_n >= 0,  v_n >= wanted,  one of them an equation;   |r_t| <= friction r_n,  v_t = 0 or r_t against it.
//
// They are the fixed point of r <- P(r - m (v - wanted)), P onto the cone, for every mass m. From the forces
// of the tick before, a few of these steps with the spectral mass |dr|^2 / (dr.W dr) (Barzilai and Borwein
// 1988), each shortened where it would pass the least of the energy along its way (Birgin, Martinez and
// Raydan 2000). A body at rest is at the fixed point and stays there: it does not creep.
//
// `points` are by node of the lattice that the contacts are of; those of held nodes answer nothing.
//
// One owner, the core of the body; allocates only when made.
class BlockOnGround {
 public:
  BlockOnGround(int points, double mass_kg);

  // Gives contacts the impulses of the last tick, and sums them up by coordinate of the body, N s: what the
  // step begins with.
  void take_last(std::span<GroundContact> contacts, std::span<const GridPoint> points, double time_s,
                 std::vector<double>& impulses_ns);
  // After all else that pushes the body: changes the impulses, and the body's velocities by what they do.
  // Working memory: `impulses_ns`, by coordinate of the body.
  void solve(const GroundContacts& ground, std::span<GroundContact> contacts,
             std::span<const GridPoint> points, double time_s, double push_speed_cap_m_per_s,
             ImplicitBody& body, std::vector<double>& impulses_ns);

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    visit(&mass_, 1);
  }

 private:
  // What is wrong with the points' velocities.
  void take_misses(std::span<const GroundContact> contacts, std::span<const GridPoint> points,
                   const ImplicitBody& body);
  // Where a step of the present mass would bring the impulses; returns the square of its length.
  double take_changes(std::span<const GroundContact> contacts);

  double mass_, least_mass_, largest_mass_;
  Vector3 normal_ = Vector3::UnitY();
  std::vector<double> wanted_;             // m/s, by contact
  std::vector<Vector3> misses_, changes_;  // m/s and N s, by contact
};

}  // namespace spoonbill
