// Contacts of an implicitly stepped body with the ground, solved all together once a tick.
#pragma once

#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/material/contact/ground_contacts.h"
#include "engine/material/implicit/grid_point.h"
#include "engine/material/implicit/implicit_body.h"

namespace spoonbill {

// Contacts of an implicitly stepped body with the ground, solved all together once a tick.
//
// Impulses r on points of the body change their velocities by W r, where W is the response of the whole body.
// The solution satisfies these complementarity conditions, with Coulomb friction, for the normal parts r_n,
// v_n and the tangential parts r_t, v_t of the impulses and velocities:
//
//   r_n >= 0,  v_n >= target,  with equality in one of them;
//   |r_t| <= friction r_n,  v_t = 0 or r_t opposite to v_t.
//
// The solution is the fixed point of r <- P(r - m (v - target)) with the projection P onto the friction cone,
// for every mass m. Starting from the forces of the last tick, a few of these steps are taken with the
// spectral mass m = |dr|^2 / (dr.W dr) (Barzilai and Borwein 1988). A step that would pass the minimum of the
// energy along its direction is shortened to that minimum, but to no less than a tenth of its length (Birgin,
// Martinez and Raydan 2000). A body at rest is at the fixed point and does not creep.
//
// The argument `points` has one entry for each node of the lattice to which the contacts belong. Points that
// are attached mostly to fixed nodes do not respond.
//
// Owned by the implicit solver of the body. Allocates only at construction.
class ImplicitGroundContacts {
 public:
  ImplicitGroundContacts(int points, double mass_kg);
  // Scales the spectral mass and its bounds by `factor`. Call after the body's inertia has changed by this
  // factor.
  void scale_inertia(double factor);

  // Sets the impulse of each contact to its force in the last tick times `time_s`. The step starts from these
  // impulses. Adds them to `impulses_ns`, one entry per coordinate of the body.
  void restore_last_impulses(std::span<GroundContact> contacts, std::span<const GridPoint> points,
                             double time_s, std::vector<double>& impulses_ns);
  // Solves the contacts. Call after everything else has pushed the body. Changes the impulses of the contacts
  // and the body's velocities. Overwrites `impulses_ns`, one entry per coordinate of the body.
  void solve(const GroundContacts& ground, std::span<GroundContact> contacts,
             std::span<const GridPoint> points, double time_s, double push_speed_cap_m_per_s,
             ImplicitBody& body, std::vector<double>& impulses_ns);

  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    visit(&mass_, 1);
  }

 private:
  // Computes the velocity of each contact's point minus its target velocity, m/s; 0 for a point that does not
  // respond.
  void compute_velocity_errors(std::span<const GroundContact> contacts, std::span<const GridPoint> points,
                               const ImplicitBody& body);
  // Computes the changes of the impulses for one step, with `mass_` as the impulse per velocity error.
  // Returns the square of their norm.
  double compute_impulse_changes(std::span<const GroundContact> contacts);

  double mass_, min_mass_, max_mass_;
  Vector3 normal_ = Vector3::UnitY();
  std::vector<double> target_;  // for each contact: smallest speed along the normal, m/s
  std::vector<Vector3> velocity_errors_, impulse_changes_;  // for each contact, m/s and N s
};

}  // namespace spoonbill
