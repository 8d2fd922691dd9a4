// The spring lattice of one body: masses, springs and volume forces on a LatticeMesh, and their state. One
// owner; stepped by relax() (lattice_solver.h). Built outside the tick, allocates nothing afterwards.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice_materials.h"
#include "engine/material/lattice_report.h"
#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill {

class SpringLattice {
 public:
  // `youngs_modulus_pa` replaces that of the body's own material where sculpting softens it; those of its
  // regions are softened by the same ratio. Refused: fewer than 2 nodes a direction, folded cells, materials
  // outside their ranges.
  //
  // Cells that share a spring add up its stiffness, damping and stiffening; it flows and creeps as the one
  // does from which it has most of its stiffness.
  static Result<SpringLattice> make(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                    double youngs_modulus_pa, InstructionSet set);

  const LatticeMesh& mesh() const { return mesh_; }
  const LatticeReport& report() const { return report_; }
  double mass_kg() const { return total_mass_; }
  double volume_m3() const;  // of the deformed body
  double rest_volume_m3() const { return rest_volume_; }
  double youngs_modulus_pa() const { return youngs_modulus_; }

  // The fastest angular frequency, rad/s: measured when built and followed as the lattice deforms.
  double fastest_frequency() const { return fastest_frequency_; }
  void set_fastest_frequency(double omega) { fastest_frequency_ = static_cast<float>(omega); }
  // Voigt damping time of every spring and cell, s. Of a body of several materials, the least of theirs: what
  // the others are damped by beyond it, LatticeKernels::damp_further() adds. A material's own is 2 z / w with
  // the fastest frequency w of the lattice, slower as its pressure waves are slower than the fastest.
  float damping_time_s() const { return damping_time_; }
  bool is_damped_further() const { return !slowest_damping_.empty(); }
  // The damping ratio at the fastest frequency, as far as it bears on the step limit.
  double damping_ratio() const { return 0.5 * static_cast<double>(step_damping_time_) * fastest_frequency(); }
  const LatticeMaterials& materials() const { return materials_; }
  // The body's own.
  const Material& material() const { return materials_.own(); }
  double friction(int node) const { return materials_.friction(node); }
  bool flows() const { return flows_; }
  bool creeps() const { return creeps_; }
  float cell_size_m() const { return cell_size_; }

  // Every free node is this light in contacts, 1/kg: of a lattice that something else moves. 0: each has its
  // own mass.
  void set_contact_inverse_mass(double inverse_mass_per_kg);
  // Held nodes keep their displacement exactly. One byte a node, 1 = held.
  void hold(std::span<const std::uint8_t> held);
  bool is_held(int node) const { return inverse_mass_[node] == 0.0f; }
  bool has_held_nodes() const { return held_count_ > 0; }
  int held_count() const { return held_count_; }
  float inverse_mass(int node) const { return inverse_mass_[node]; }
  // 0 of the second of two nodes that are one place.
  float mass(int node) const { return node_mass_[node]; }

  // Displacements from the rest shape along one axis, m, one a node.
  const float* displacements(int axis) const { return (axis == 0 ? dx_ : axis == 1 ? dy_ : dz_).data(); }
  Vector3 displacement(int node) const { return {dx_[node], dy_[node], dz_[node]}; }
  Vector3 position(int node) const { return mesh_.nodes[node] + displacement(node); }
  std::vector<Vector3> positions() const;  // of all nodes
  Vector3 velocity(int node) const { return {vx_[node], vy_[node], vz_[node]}; }
  // Of both nodes of a place.
  void set_displacement(int node, const Vector3& d);
  void set_velocity(int node, const Vector3& v);
  // Moves a node, and its twin, for good: its springs and cells take their new lengths and volumes as their
  // rest, so that no strain changes. False, and nothing changed, where a spring would leave half to twice its
  // first length, as in flow, or a cell a quarter to four times its first volume.
  bool reform(int node, const Vector3& move_m);
  // A force on a node that stays until changed, N.
  void set_node_force(int node, const Vector3& force_n);

  // Views of the state; pointers stay valid for the lattice's life at its present address.
  LatticeView view();
  const LatticeKernels& kernels() const { return *kernels_; }
  const float* free_mass() const { return free_mass_.data(); }
  // Makes a substep of h_s stable whatever the strain: a node whose mass is too small for its stiffness now
  // counts as heavier, at the momentum that it has. Returns the inverse masses to step with, valid until the
  // next call; `share` is of the stability limit.
  const float* steady_strained_nodes(float h_s, float share);
  const float* applied_force(int axis) const { return applied_[axis].data(); }
  bool has_applied_force() const { return has_applied_force_; }

  // Calls visit(const float*, count) on each array of the shape: displacements, velocities, rest lengths and
  // volumes, and what crept.
  template <class Visitor>
  void visit_shape(Visitor&& visit) const {
    for (const auto* a : {&dx_, &dy_, &dz_, &vx_, &vy_, &vz_}) visit(a->data(), a->size());
    for (const auto& a : rest_length_) visit(a.data(), a.size());
    for (const auto& a : square_difference_) visit(a.data(), a.size());
    for (const auto& a : crept_) visit(a.data(), a.size());
    visit(rest_volume_sum_.data(), rest_volume_sum_.size());
  }
  // The same, and what else the next step depends on.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    visit_shape(visit);
    for (const auto* a : {&power_x_, &power_y_, &power_z_}) visit(a->data(), a->size());
    visit(&fastest_frequency_, 1);
  }
  std::vector<float> shape() const;
  // Allocates only where `shape` has not held one of this lattice before.
  void write_shape(std::vector<float>& shape) const;
  std::size_t shape_size() const;
  // False, and nothing changed, when the sizes differ.
  bool set_shape(std::span<const float> shape);

 private:
  SpringLattice() = default;
  void lay_out(const LatticeMesh& mesh);
  struct Assembly;
  void assemble(Assembly& sum);
  void add_cell(int i, int j, int k, Assembly& sum);
  void join_nodes(Assembly& sum);
  void store_nodes(const Assembly& sum);
  void store_springs(int direction, const Assembly& sum);
  void store_stiffening(const Assembly& sum);
  void store_flow_and_creep(const Assembly& sum);
  void take_damping(const Assembly& sum);
  void take_further_damping(const Assembly& sum, const std::vector<double>& times_s);
  double damped_square();
  float measured_frequency();
  void find_active_blocks();
  float free_inverse_mass(int node) const;
  // The springs and cells around a node, and what they become where it moves.
  struct Reforming;
  bool reform_springs(int node, const Vector3& move, Reforming& next) const;
  bool reform_cells(int node, const Vector3& move, Reforming& next) const;
  void take_reformed(const Reforming& next);

  using Floats = AlignedVector<float>;

  LatticeMesh mesh_;
  LatticeReport report_;
  const LatticeKernels* kernels_ = nullptr;
  double total_mass_ = 0.0, rest_volume_ = 0.0, youngs_modulus_ = 0.0;
  LatticeMaterials materials_{Material{}};
  float fastest_frequency_ = 0.0f, damping_time_ = 0.0f, step_damping_time_ = 0.0f, cell_size_ = 0.0f;
  float contact_inverse_mass_ = 0.0f;
  bool has_applied_force_ = false, flows_ = false, creeps_ = false;
  int held_count_ = 0, padded_count_ = 0;
  std::vector<int> seam_;  // see LatticeView::seam
  int offset_[lattice_direction_count] = {};

  Floats dx_, dy_, dz_, vx_, vy_, vz_, fx_, fy_, fz_;
  Floats ahead_[3], reference_[3], moved_[3], spring_force_[3];
  Floats node_mass_, free_mass_, inverse_mass_, free_node_;
  std::vector<std::uint8_t> active_block_, free_block_;
  Floats applied_[3];
  Floats rest_x_[lattice_direction_count], rest_y_[lattice_direction_count], rest_z_[lattice_direction_count];
  Floats stiffness_[lattice_direction_count], rest_length_[lattice_direction_count];
  Floats square_difference_[lattice_direction_count], first_rest_length_[lattice_direction_count];
  Floats crept_[lattice_direction_count], tangent_[lattice_direction_count];
  // Of a body of several materials, where these differ; else empty.
  Floats stiffening_[lattice_direction_count], further_damping_[lattice_direction_count];
  Floats yield_[lattice_direction_count], hardening_[lattice_direction_count];
  Floats flow_rate_[lattice_direction_count], relaxing_share_[lattice_direction_count];
  Floats relaxation_time_[lattice_direction_count];
  Floats further_bulk_damping_;
  Floats slowest_damping_;  // by node: of the cells around it, beyond the least damping time, s
  Floats bulk_, crushed_, inverse_volume_, rest_volume_sum_, has_cell_, inverse_cell_count_, node_dilation_;
  Floats row_sum_, stable_inverse_mass_;
  Floats power_x_, power_y_, power_z_, power_noise_;
};

}  // namespace spoonbill
