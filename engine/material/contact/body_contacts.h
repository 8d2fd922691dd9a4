// Contact between bodies that both give way, or of one with itself: velocity constraints between points of
// their surfaces, solved within each substep beside those of the tools. What one point gets the other loses,
// so that momentum stays.
#pragma once

#include <span>
#include <vector>

#include "engine/material/lattice/embedded_point.h"

namespace spoonbill {

// A point of a body: `body` is the lattice's place in the views that solve() gets.
struct BodyPoint {
  int body = 0;
  const SpringLattice* lattice = nullptr;
  EmbeddedPoint point;
};

// Working memory for the contacts of one tick. One owner, one thread; allocates only in its constructor.
class BodyContacts {
 public:
  explicit BodyContacts(int capacity);

  void clear();
  // Both may be of the same body, and share nodes. The first point must stay on that side of the second to
  // which `normal`, a unit vector, points; now it is `gap_m` beyond it, below zero where it is behind. False
  // when full.
  bool add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m);

  // Begins a tick.
  void begin();

  // After the kick and before the drift of a substep of h_s.
  void solve(std::span<const LatticeView> lattices, float h_s,
             std::span<const float> push_speed_caps_m_per_s);

  int count() const { return count_; }
  // Whether any of a body's, or of two bodies with each other, has acted since begin().
  bool acted(int body) const;
  bool acted(int body, int other) const;
  // Marks the nodes of a body's constraints that acted.
  void mark_touched(int body, std::uint8_t* touched) const;

 private:
  struct Constraint {
    int first_body = 0, second_body = 0;
    EmbeddedPoint first, second;
    Vector3 normal = Vector3::UnitY();
    double compliance = 0.0;  // what an impulse between them gives them of velocity, 1/kg
    double base_m = 0.0;      // the gap less the part that the displacements have in it
    double friction = 0.0;    // of the smoother one
    bool acted = false;
  };
  void solve(std::span<const LatticeView> lattices, Constraint& constraint, double h, double cap);

  std::vector<Constraint> constraints_;
  int count_ = 0;
};

}  // namespace spoonbill
