// Spring lattice of one body: masses, springs and volume forces on a LatticeMesh, with their state. It is
// built outside the tick and stepped by relax() (lattice_solver.h), which does not allocate. A lattice has
// one owner and is used on one thread at a time.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/geometry.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/material/cells/cell_elasticity.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice/outside_nodes.h"
#include "engine/material/lattice_materials.h"
#include "engine/material/springs/flat_corners.h"
#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill {

// Substep of an undeformed lattice, as a fraction of the stability limit. Strain and flow raise the fastest
// frequency by a factor of 1.2 to 1.6; a tick then takes more substeps.
inline constexpr double rest_stability_fraction = 0.75;

// Mean velocity of the nodes of a lattice, and the highest speed of a node relative to it, m/s.
struct NodeSpeeds {
  Vector3 mean_m_per_s = Vector3::Zero();
  double fastest_from_mean_m_per_s = 0.0;
};

class SpringLattice {
 public:
  // Builds the lattice at rest with an inertia scale of 1, at which the inertia of each node is its mass.
  // Fails on fewer than 2 nodes in a direction, folded cells and materials outside their ranges.
  //
  // Cells that share a spring add their stiffness, damping and stiffening to it. If their materials differ,
  // the spring flows and creeps like the material that contributes most of its stiffness.
  static Result<SpringLattice> make(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                    InstructionSet set);

  const LatticeMesh& mesh() const { return mesh_; }
  const LatticeReport& report() const { return report_; }
  double mass_kg() const { return total_mass_; }
  // Volume of the deformed body, m^3.
  double volume_m3() const;
  double rest_volume_m3() const { return rest_volume_; }
  // Returns by how much reform() has changed the cells' volume at rest, as a fraction of it.
  double rest_volume_change() const;

  // Inertia of the nodes divided by their mass, at least 1. A larger inertia lets a tick take fewer substeps.
  // At rest, every force is the true one; a motion takes sqrt(scale) times as long as the real one ("mass
  // scaling" in explicit finite element codes, see Olovsson et al. 2005).
  double inertia_scale() const { return inertia_scale_; }
  // Sets the inertia scale for substeps of about step_s. May allocate if step_s changes.
  void set_inertia(double scale, double step_s);
  // Returns the smallest inertia scale with which a substep of step_s is stable at rest, with the reserve of
  // rest_stability_fraction. Allocates.
  double find_inertia_scale(double step_s);
  // Returns the longest of the substeps longest_s, longest_s / 2, longest_s / 3 and so on that is stable at
  // rest and at an inertia scale of 1, with the reserve of rest_stability_fraction. Allocates.
  double find_real_time_step_s(double longest_s);

  // Square of the largest angular frequency, rad^2/s^2, of the lattice with its inertia scale and with its
  // springs weighted for the step of set_inertia(). It is measured at rest and tracked while the lattice
  // deforms.
  double fastest_square() const { return static_cast<double>(fastest_square_); }
  void set_fastest_square(double square) { fastest_square_ = static_cast<float>(square); }
  // Upper bound of the largest angular frequency of the undamped lattice, rad/s.
  double fastest_frequency() const;
  // Returns the largest stable substep, s, at the present strain; `fraction` is the fraction of the stability
  // limit to use.
  double stable_step_s(double fraction) const;
  // Weight of the springs' stiffness in power steps and row sums for substeps of step_s (see
  // LatticeView::spring_weight).
  double spring_weight(double step_s) const {
    return 1.0 + 2.0 * static_cast<double>(step_damping_time_) / step_s;
  }
  // Damping time that all springs have at least, s: the shortest damping time of the body's materials.
  // LatticeKernels::damp_further() adds the damping of materials with a longer time.
  float damping_time_s() const { return damping_time_; }
  bool is_damped_further() const { return is_damped_further_; }
  const LatticeMaterials& materials() const { return materials_; }
  // Returns the material of the body outside its regions.
  const Material& material() const { return materials_.own(); }
  double friction(int node) const { return materials_.friction(node); }
  bool flows() const { return flows_; }
  bool creeps() const { return creeps_; }
  float cell_size_m() const { return cell_size_; }

  // Sets the inverse inertia that contacts use for every free node, 1/kg, in a lattice that the implicit
  // solver moves. 0 restores each node's own inertia.
  void set_contact_inverse_mass(double inverse_mass_per_kg);
  bool moved_by_solver() const { return contact_inverse_mass_ > 0.0f; }
  // Fixes the nodes whose byte is not 0 at their present displacements and frees all others; one byte per
  // node. The twin of a fixed node at the seam is fixed too.
  void fix_nodes(std::span<const std::uint8_t> fixed);
  bool is_fixed(int node) const { return inverse_mass_[node] == 0.0f; }
  bool has_fixed_nodes() const { return fixed_count_ > 0; }
  int fixed_count() const { return fixed_count_; }
  // 1 / inertia of a node, 1/kg; 0 for a fixed node.
  float inverse_mass(int node) const { return inverse_mass_[node]; }
  // Mass of a node, kg; 0 for the second of two nodes that are joined at the seam.
  float mass(int node) const { return node_mass_[node]; }

  // Displacements from the rest shape along one axis, m, one per node.
  const float* displacements(int axis) const { return (axis == 0 ? dx_ : axis == 1 ? dy_ : dz_).data(); }
  // Velocities along one axis, m/s, one per node.
  const float* velocities(int axis) const { return (axis == 0 ? vx_ : axis == 1 ? vy_ : vz_).data(); }
  Vector3 displacement(int node) const { return {dx_[node], dy_[node], dz_[node]}; }
  Vector3 position(int node) const { return mesh_.nodes[node] + displacement(node); }
  // Deformed positions of all nodes, m.
  std::vector<Vector3> positions() const;
  // Velocities of a soft tool's lattice are relative to the tool (see MovingFrame).
  Vector3 velocity(int node) const { return {vx_[node], vy_[node], vz_[node]}; }
  // Returns the highest speed of a node, m/s.
  double fastest_m_per_s() const;
  NodeSpeeds find_node_speeds() const;
  // Sets the displacement of a node and of its twin at the seam, m.
  void set_displacement(int node, const Vector3& d);
  void set_velocity(int node, const Vector3& v);
  // Moves a node and its twin permanently. Rest lengths and rest volumes change by as much as the lengths of
  // springs and the volumes of cells do, so that no spring is extended further. Returns false and changes
  // nothing if a rest length would be outside 0.5 to 2 times its initial value, as in flow, or a rest volume
  // outside 0.25 to 4 times.
  bool reform(int node, const Vector3& move_m);
  // Sets the force on a node, N; it acts until it is changed.
  void set_node_force(int node, const Vector3& force_n);

  // Returns a view of the state. Its pointers stay valid until the C++ object is moved or destroyed.
  LatticeView view();
  const LatticeKernels& kernels() const { return *kernels_; }
  // masses() returns the masses of all nodes, kg, like mass(). free_mass() is the same, but 0 for fixed
  // nodes.
  const float* masses() const { return node_mass_.data(); }
  const float* free_mass() const { return free_mass_.data(); }
  // Makes a substep of h_s stable at any strain: a node that is too light for its present stiffness gets a
  // larger inertia at the same momentum. Returns the inverse inertias for this substep, valid until the next
  // call. `fraction` is the fraction of the stability limit to use.
  const float* stabilise_strained_nodes(float h_s, float fraction);
  // Gives the free nodes outside the body the displacements, or the velocities, with which the body's motion
  // continues there (see OutsideNodes), below the speed cap.
  void continue_displacements();
  void continue_velocities(const SpeedCap& cap);
  // find_flat_corners() finds at the start of a tick which cells may be turned inside out, and
  // resist_inversion() adds their resistance to the forces of a substep of h_s (see FlatCorners).
  void find_flat_corners() { flat_corners_.find(kernels(), view()); }
  void resist_inversion(const LatticeView& view, float h_s) const { flat_corners_.add_forces(view, h_s); }
  const float* applied_force(int axis) const { return applied_[axis].data(); }
  bool has_applied_force() const { return has_applied_force_; }

  // Calls visit(const float*, count) for each array that describes the shape: displacements, velocities, rest
  // lengths, rest volumes and creep strains.
  template <class Visitor>
  void visit_shape(Visitor&& visit) const {
    for (const auto* a : {&dx_, &dy_, &dz_, &vx_, &vy_, &vz_}) visit(a->data(), a->size());
    visit_rest(visit);
  }
  // Visits what visit_shape() does, except the velocities.
  template <class Visitor>
  void visit_deformation(Visitor&& visit) const {
    for (const auto* a : {&dx_, &dy_, &dz_}) visit(a->data(), a->size());
    visit_rest(visit);
  }
  // Visits rest lengths, creep strains and rest volumes.
  template <class Visitor>
  void visit_rest(Visitor&& visit) const {
    for (const auto& a : rest_length_) visit(a.data(), a.size());
    for (const auto& a : square_difference_) visit(a.data(), a.size());
    for (const auto& a : crept_) visit(a.data(), a.size());
    visit(rest_volume_sum_.data(), rest_volume_sum_.size());
  }
  // Visits the shape, the vector of the power iteration, the fastest square and the inertia scale.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    visit_shape(visit);
    for (const auto* a : {&power_x_, &power_y_, &power_z_}) visit(a->data(), a->size());
    for (const float* value : {&fastest_square_, &inertia_scale_}) visit(value, 1);
  }
  std::vector<float> shape() const;
  // Copies the shape into `shape`. Allocates only if the vector has less capacity than a shape of this
  // lattice needs.
  void write_shape(std::vector<float>& shape) const;
  std::size_t shape_size() const;
  // Restores a shape. Returns false and changes nothing if the size differs.
  bool set_shape(std::span<const float> shape);

 private:
  using Floats = AlignedVector<float>;
  // The fastest mode of the lattice at rest with an inertia scale of 1.
  struct RestMode {
    float spring_weight;
    float fastest_square;
    Floats power_x, power_y, power_z;  // vector of the power iteration
  };

  SpringLattice() = default;
  void allocate(const LatticeMesh& mesh);
  struct Assembly;
  void assemble(Assembly& sum);
  void add_cell(int i, int j, int k, Assembly& sum);
  void join_nodes(Assembly& sum);
  void store_nodes(const Assembly& sum);
  void store_springs(int direction, const Assembly& sum);
  void store_stiffening(const Assembly& sum);
  void store_flow_and_creep(const Assembly& sum);
  void set_damping(const Assembly& sum);
  void start_power_iteration();
  void add_to_power_vector(const RestMode& mode);
  RestMode measure_fastest_mode(int steps);
  const RestMode& find_rest_mode(float weight);
  void adopt_mode(const RestMode& mode);
  SpringLattice at_rest() const;
  void find_active_blocks();
  float free_inverse_mass(int node) const;
  // New rest lengths and volumes around a node that reform() is about to move.
  struct Reforming;
  bool reform_springs(int node, const Vector3& move, Reforming& next) const;
  bool reform_cells(int node, const Vector3& move, Reforming& next) const;
  void apply_reforming(const Reforming& next);

  LatticeMesh mesh_;
  OutsideNodes outside_;
  FlatCorners flat_corners_;
  LatticeReport report_;
  const LatticeKernels* kernels_ = nullptr;
  double total_mass_ = 0.0, rest_volume_ = 0.0;
  LatticeMaterials materials_{Material{}};
  float fastest_square_ = 0.0f, inertia_scale_ = 1.0f, spring_weight_ = 1.0f, cell_size_ = 0.0f;
  // Shortest and longest damping time of the materials, s.
  float damping_time_ = 0.0f, step_damping_time_ = 0.0f;
  float contact_inverse_mass_ = 0.0f;
  bool has_applied_force_ = false, flows_ = false, creeps_ = false, is_damped_further_ = false;
  std::vector<RestMode> rest_modes_;  // one for each spring weight that was needed
  int fixed_count_ = 0, padded_count_ = 0;
  std::vector<int> seam_;  // pairs of joined nodes, see LatticeView::seam
  int offset_[lattice_direction_count] = {};

  Floats dx_, dy_, dz_, vx_, vy_, vz_, fx_, fy_, fz_;
  Floats reference_[3], moved_[3], spring_force_[3];
  Floats node_mass_, free_mass_, inverse_mass_, free_node_;
  std::vector<std::uint8_t> active_block_, free_block_;
  Floats applied_[3];
  Floats rest_x_[lattice_direction_count], rest_y_[lattice_direction_count], rest_z_[lattice_direction_count];
  Floats stiffness_[lattice_direction_count], rest_length_[lattice_direction_count];
  Floats square_difference_[lattice_direction_count], first_rest_length_[lattice_direction_count];
  Floats crept_[lattice_direction_count], tangent_[lattice_direction_count];
  // If the materials of the body differ in a property, its array has one value for each spring; otherwise it
  // is empty.
  Floats stiffening_[lattice_direction_count], further_damping_[lattice_direction_count];
  Floats yield_[lattice_direction_count], hardening_[lattice_direction_count];
  Floats flow_rate_[lattice_direction_count], relaxing_fraction_[lattice_direction_count];
  Floats relaxation_time_[lattice_direction_count];
  Floats bulk_, crushed_, inverse_volume_, rest_volume_sum_, has_cell_, inverse_cell_count_, node_dilation_;
  Floats row_sum_, stable_inverse_mass_;
  Floats power_x_, power_y_, power_z_, power_noise_;
};

// Sets the velocity of a node in a view, m/s.
inline void set_velocity(const LatticeView& view, int n, const Vector3& velocity) {
  view.vx[n] = static_cast<float>(velocity.x());
  view.vy[n] = static_cast<float>(velocity.y());
  view.vz[n] = static_cast<float>(velocity.z());
}

// Moves the first `count` nodes rigidly by `shift_m`. The linearisation moves with them.
void shift_nodes(const LatticeView& view, int count, const Vector3& shift_m);

// Moves the second node of each seam pair to the first.
void join_seam_positions(const LatticeView& view);

// Sets a node's displacement, and the change of its extrapolated displacement since the linearisation, as
// drift() does. `tau` is the damping time. Returns the square of that change, m^2.
inline float set_node_displacement(const LatticeView& view, int n, const Vector3& displacement, float tau) {
  float* const d[3] = {view.dx, view.dy, view.dz};
  float* const moved[3] = {view.moved_x, view.moved_y, view.moved_z};
  const float* const v[3] = {view.vx, view.vy, view.vz};
  const float* const reference[3] = {view.reference_x, view.reference_y, view.reference_z};
  float square = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    d[axis][n] = static_cast<float>(displacement[axis]);
    moved[axis][n] = d[axis][n] + tau * v[axis][n] - reference[axis][n];
    square += moved[axis][n] * moved[axis][n];
  }
  return square;
}

}  // namespace spoonbill
