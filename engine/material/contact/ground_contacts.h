// The rigid ground under bodies: velocity constraints on their nodes, solved within each substep after all
// others.
#pragma once

#include <span>
#include <vector>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

// Working memory for the contacts of one tick. Each is of one node alone, so that a single pass solves them
// exactly and what sticks does not creep. One owner, one thread; allocates only in its constructor.
class GroundContacts {
 public:
  explicit GroundContacts(int capacity);

  void clear();
  // What hangs on a node is `gap_m` above the ground, below zero where it is in it. `body` is the lattice's
  // place in the views that solve() gets. False when full.
  bool add(int body, const SpringLattice& lattice, int node, double gap_m, double friction);

  // Begins a tick; `normal`, a unit vector, points out of the ground. After add().
  void begin(const Vector3& normal);

  // After the kick and before the drift; each lattice then moves for its time.
  void solve(std::span<const LatticeView> lattices, std::span<const double> times_s,
             std::span<const float> push_speed_caps_m_per_s);

  int count() const { return count_; }
  // What the ground gave a body since begin(), N s.
  Vector3 impulse_ns(int body) const;
  // Marks the nodes of a body that it pushed.
  void mark_touched(int body, std::uint8_t* touched) const;

 private:
  struct Constraint {
    int body = 0, node = 0;
    double gap_m = 0.0;
    Vector3 at_m = Vector3::Zero();  // the node's displacement, to which the gap belongs
    double friction = 0.0;
    Vector3 impulse_ns = Vector3::Zero();
  };

  std::vector<Constraint> constraints_;
  int count_ = 0;
  Vector3 normal_ = Vector3::UnitY();
};

}  // namespace spoonbill
