// A body whose material is too stiff for springs to be stepped in a tick: corotated hexahedra under an
// implicit Euler method, stable at any step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/material/implicit/block_materials.h"
#include "engine/material/implicit/rolling_factor.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice_report.h"
#include "engine/scene/material.h"

namespace spoonbill {

struct ImplicitStep {
  double step_s = 1e-3;
  double damping_per_s = 0.0;  // mass-proportional
  Vector3 gravity_m_per_s2 = Vector3::Zero();
};

struct ImplicitReport {
  int iterations = 0;     // of the conjugate gradients
  double residual = 0.0;  // what they left, of what they began with, in the norm of the factors
};

// The velocities w at the end of a step h solve
//
//   (M (1 + h a) + (h^2 + h t) K) w = M v + h (f - f_el(x)),  x <- x + h w,
//
// with the damping a by mass and t by stiffness: one step of Newton's method. K is the plain tangent at x,
// which is never indefinite, so the matrix is positive definite and conjugate gradients may stop early: what
// they have by then never stores more energy than standing still would. Their preconditioner is the Cholesky
// factor of the same matrix as it was a few ticks ago, taken a piece each tick: bodies are long, and their
// nodes counted along them, so that it is a narrow band.
// Nodes that are held and moved have w given: what they pull at the free ones goes to the right.
//
// A node may move at most half a cell in a step, beside the body as a whole, or where a node is held: what
// crushes cells faster cannot be undone.
//
// One owner; built outside the tick, allocates nothing afterwards.
class ImplicitBody {
 public:
  // Of several materials the damping ratio is the stiffest one's, for the fastest mode is there; what else
  // differs between them counts by part. Refused: fewer than 2 nodes a direction, folded cells, materials
  // outside their ranges.
  static Result<ImplicitBody> make(const LatticeMesh& mesh, const BlockMaterials& materials,
                                   InstructionSet set);
  ImplicitBody(ImplicitBody&&) = default;
  ImplicitBody& operator=(ImplicitBody&&) = default;
  ImplicitBody(const ImplicitBody&) = delete;
  ImplicitBody& operator=(const ImplicitBody&) = delete;

  const LatticeMesh& mesh() const { return mesh_; }
  int node_count() const { return mesh_.node_count(); }
  // 0 of the second of two nodes that are one place.
  double mass_kg(int node) const { return mass_[static_cast<std::size_t>(node)]; }
  double damping_time_s() const { return damping_time_; }
  const LatticeReport& report() const { return report_; }

  // One byte a node, 1 = held. Takes the factor anew.
  void hold(std::span<const std::uint8_t> held);
  bool is_held(int node) const { return free_[3 * static_cast<std::size_t>(mesh_.joined(node))] == 0.0; }

  // Of either node of a place.
  Vector3 displacement(int node) const { return at(moved_, mesh_.joined(node)); }
  Vector3 velocity(int node) const { return at(velocity_, mesh_.joined(node)); }
  void set_displacement(int node, const Vector3& d) { put(moved_, mesh_.joined(node), d); }
  void set_velocity(int node, const Vector3& v) { put(velocity_, mesh_.joined(node), v); }
  // Until changed, N.
  void set_node_force(int node, const Vector3& force_n) { put(applied_, mesh_.joined(node), force_n); }
  void add_node_force(int node, const Vector3& force_n) {
    const int joined = mesh_.joined(node);
    put(applied_, joined, at(applied_, joined) + force_n);
  }
  void clear_node_forces() { std::fill(applied_.begin(), applied_.end(), 0.0); }
  // Moves a held node in the coming steps, until hold() is called.
  void move_held(int node, const Vector3& velocity_m_per_s) {
    put(held_velocity_, mesh_.joined(node), velocity_m_per_s);
    held_moves_ = true;
  }
  // On a held node, N: what its cells and the applied force did as the last step began.
  Vector3 force_on_held(int node) const { return at(force_, mesh_.joined(node)); }

  // Of the free nodes' velocities, with the tangent of the last step: (v.Kv) / (v.Mv); 0 at rest.
  double rayleigh_quotient();

  // A step in its parts: the velocities at its end, with what is known of the contacts' impulses, by
  // coordinate (of the first node of each place), N s; what contacts push further, as far as the whole body
  // answers at once, with the work that they do on what they change, J; and the move, which says whether a
  // node met the speed cap.
  ImplicitReport solve_velocities(const ImplicitStep& step, std::span<const double> known_ns = {});
  double push(const std::vector<double>& impulses) {
    const double work = answer(impulses);
    take_answer(1.0);
    return work;
  }
  // The same before it is done, and a share of it done.
  double answer(const std::vector<double>& impulses);
  void take_answer(double share);
  bool move(double step_s);
  // All of it without contacts.
  ImplicitReport step(const ImplicitStep& step) {
    const ImplicitReport report = solve_velocities(step);
    move(step.step_s);
    return report;
  }

  // All that the next step depends on.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const Doubles* a : {&moved_, &velocity_, &applied_}) visit(a->data(), a->size());
    factor_.visit_state(visit);
    for (const CellBatch& batch : block_.batches) visit(&batch.quaternion[0][0], 4 * std::size_t{cell_lanes});
  }

 private:
  using Doubles = AlignedVector<double>;

  ImplicitBody(const LatticeMesh& mesh, const BandKernels& band, const CellKernels& cells);
  static Vector3 at(const Doubles& of, int node) {
    const double* const p = of.data() + 3 * static_cast<std::ptrdiff_t>(node);
    return {p[0], p[1], p[2]};
  }
  static void put(Doubles& of, int node, const Vector3& v) {
    for (int axis = 0; axis < 3; ++axis) of[3 * static_cast<std::size_t>(node) + axis] = v[axis];
  }
  void take_cells(const BlockMaterials& materials);
  void take_damping(const BlockMaterials& materials);
  void free_only(Doubles& of) const;
  double fastest_square();

  struct RigidMotion {
    Vector3 centre_m = Vector3::Zero(), velocity_m_per_s = Vector3::Zero(), spin_rad_per_s = Vector3::Zero();

    Vector3 velocity_at(const Vector3& place_m) const {
      return velocity_m_per_s + spin_rad_per_s.cross(place_m - centre_m);
    }
  };
  Vector3 place(int node) const { return mesh_.nodes[static_cast<std::size_t>(node)] + displacement(node); }
  RigidMotion rigid_motion() const;
  bool cap_speeds(const RigidMotion& motion, double cap_m_per_s);
  void move_and_turn(const RigidMotion& motion, double step_s);
  Vector3 sum_over_nodes(const Doubles& of) const;
  void restore_momentum();
  void apply_matrix(double inertia, double stiffness, const Doubles& field, Doubles& out) const;
  void take_held_motion(double stiffness, double h);
  void begin_solve(double inertia, double stiffness, double h);
  ImplicitReport solve(double inertia, double stiffness);

  LatticeMesh mesh_;
  LatticeReport report_;
  const BandKernels* band_;
  const CellKernels* cells_;
  double damping_time_ = 0.0, cell_size_;
  int size_;  // coordinates
  bool has_held_nodes_ = false, held_moves_ = false;
  Vector3 momentum_ = Vector3::Zero();  // of a free body, at the end of the step
  RollingFactor factor_;
  CellBlock block_;
  Doubles mass_, mass3_, free_;  // by node; by coordinate, 0 where held; 1 or 0
  Doubles moved_, velocity_, applied_;
  Doubles held_velocity_;                                       // 0 of free nodes
  Doubles force_, residual_, direction_, image_, conditioned_;  // working memory
};

}  // namespace spoonbill
