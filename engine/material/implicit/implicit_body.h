// Body that is stepped by the implicit Euler method, because explicitly stepped springs would be unstable at
// the length of a tick. It consists of corotated hexahedra. The method is stable at any step length.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"
#include "engine/material/cells/cell_elasticity.h"
#include "engine/material/cells/hexahedron.h"
#include "engine/material/implicit/rolling_factor.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice_materials.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Overlap of a cell of the implicit solver's coarse grid with a cell of the lattice, along one axis.
struct Overlap {
  int cell;          // index of the lattice's cell along the axis
  double low, high;  // ends of the overlap in the coarse cell, from -1 to 1

  // Returns the fraction of the coarse cell that the overlap covers, 0 to 1.
  double fraction() const { return 0.5 * (high - low); }
};

// Returns the overlaps of a coarse cell with the lattice's cells, in order and without gaps. The counts are
// numbers of nodes along the axis, each at least 2.
std::vector<Overlap> find_overlaps(int block_cell, int block_count, int lattice_count);

// Materials in the cells of an implicit body. A plain value type.
struct BlockMaterials {
  // A box in a cell's natural coordinates (see HexahedronPart) and the index of the material that fills it.
  struct Part {
    Vector3 low = -Vector3::Ones(), high = Vector3::Ones();
    std::size_t material = 0;
  };

  // Creates the materials of a uniform body. An implicit conversion, because most bodies are uniform.
  BlockMaterials(const Material& material) : materials{material} {}

  std::vector<Material> materials;
  // Parts that fill each cell, indexed by LatticeMesh::cell_index(). Empty if all cells have the first
  // material.
  std::vector<std::vector<Part>> parts_by_cell;
};

// Returns the materials of a coarser grid over the body of a lattice. Each cell of the coarse grid gets a
// part for each cell of the lattice that overlaps it; adjacent parts of the same material may be merged.
BlockMaterials make_block_materials(const LatticeMaterials& of, const std::array<int, 3>& lattice_count,
                                    const std::array<int, 3>& block_count);

// A cell of an implicit body, from which its stiffness, its masses and its part of the report are computed.
// Plain data.
struct BlockCell {
  CellCorners corners;
  double fraction;  // fraction of the cell that belongs to the body
  std::vector<BlockMaterials::Part> parts;
  const std::vector<Material>* materials;

  double volume_m3() const { return fraction * cell_volume(corners); }
  // Stiffness of the whole cell, N/m, not scaled by `fraction`.
  CellMatrix stiffness() const;
  // Masses by corner, kg; equal if the cell is of one material.
  std::array<double, 8> masses() const;
  // Adds to `report` the elasticity that a cell of this shape achieves for each of its materials. `stiffness`
  // is the result of stiffness().
  void report(const CellMatrix& stiffness, LatticeReport& report) const;
};

// Returns the parts of a cell, at least one.
std::vector<BlockMaterials::Part> cell_parts(const BlockMaterials& materials, std::size_t cell);

struct ImplicitStep {
  double step_s = 1e-3;
  double drag_per_s = 0.0;  // mass-proportional drag
  Vector3 gravity_m_per_s2 = Vector3::Zero();
};

struct ImplicitReport {
  int iterations = 0;     // iterations of the conjugate gradients
  double residual = 0.0;  // final residual divided by the initial one, in the norm of the preconditioner
};

// Implicit Euler method for a block of hexahedra. The velocities w at the end of a step h solve
//
//   (r M + (h^2 + h t) K) w = r M v / (1 + h a) + h (f - f_el(x)),  x <- x + h w,
//
// with the inertia scale r, the masses M, the old velocities v, the drag a, the damping time t, the applied
// forces f and the elastic forces f_el. Drag acts only on the old velocity, so that it does not change the
// equilibrium of a body at rest. This is one step of Newton's method. K is the tangent at the positions x
// without the contribution of stress (Tangent::plain). It is never indefinite, so the matrix is positive
// definite. The method itself damps every mode like an additional damping time of h. Unlike the damping of
// springs, t also damps changes of volume.
//
// The system is solved by conjugate gradients, which may stop early: at every iteration the quadratic form
// that they minimise is at most its value at w = 0. Their preconditioner is the Cholesky factor of the same
// matrix a few ticks earlier, updated in parts. Bodies are long and their nodes are numbered along them, so
// the matrix is a narrow band.
//
// A free body rotates with the spin at half of the step, as RigidDynamics does. Its momentum and angular
// momentum are known before the system is solved, since internal forces do not change them, and are set
// exactly afterwards. The Cholesky factor is in the body's frame, where a rotation does not change the
// matrix.
//
// Fixed nodes may move at prescribed velocities. The forces that they thereby exert on free nodes are added
// to the right-hand side.
//
// A node moves at most half a cell per step, relative to the rigid motion of a free body. Faster motion could
// crush cells irreversibly.
//
// Has one owner. It is built outside the tick and allocates nothing afterwards.
class ImplicitBody {
 public:
  // Builds the body at rest, with an inertia scale of 1. With several materials, the damping time is that of
  // the stiffest one; each part of a cell has all other properties of its own material. Fails on fewer than 2
  // nodes in a direction, folded cells and materials outside their ranges.
  static Result<ImplicitBody> make(const LatticeMesh& mesh, const BlockMaterials& materials,
                                   InstructionSet set);
  ImplicitBody(ImplicitBody&&) = default;
  ImplicitBody& operator=(ImplicitBody&&) = default;
  ImplicitBody(const ImplicitBody&) = default;
  ImplicitBody& operator=(const ImplicitBody&) = delete;

  const LatticeMesh& mesh() const { return mesh_; }
  int node_count() const { return mesh_.node_count(); }
  // Mass of a node, kg; 0 for the second of two joined nodes.
  double mass_kg(int node) const { return mass_[static_cast<std::size_t>(node)]; }
  double damping_time_s() const { return damping_time_; }
  // Sets the ratio of the nodes' inertia to their mass, at least 1 (SpringLattice::inertia_scale()).
  void set_inertia_scale(double scale);
  const LatticeReport& report() const { return report_; }

  // Fixes the nodes whose byte is 1 and frees all others, one byte per node. Discards the Cholesky factor.
  void fix_nodes(std::span<const std::uint8_t> fixed);
  bool is_fixed(int node) const { return free_[3 * static_cast<std::size_t>(mesh_.joined(node))] == 0.0; }

  // Returns the displacement of a node, m: the same for both nodes of a joined pair.
  Vector3 displacement(int node) const { return at(moved_, mesh_.joined(node)); }
  Vector3 velocity(int node) const { return at(velocity_, mesh_.joined(node)); }
  void set_displacement(int node, const Vector3& d) { put(moved_, mesh_.joined(node), d); }
  void set_velocity(int node, const Vector3& v) { put(velocity_, mesh_.joined(node), v); }
  // Rotates the frame in which the matrix of a free body is factorised. Call after set_displacement() has
  // rotated all nodes.
  void turn_frame(const Quaternion& turn) { frame_ = (turn * frame_).normalized(); }
  // Sets the force on a node, N; it acts until it is changed.
  void set_node_force(int node, const Vector3& force_n) { put(applied_, mesh_.joined(node), force_n); }
  void add_node_force(int node, const Vector3& force_n) {
    const int joined = mesh_.joined(node);
    put(applied_, joined, at(applied_, joined) + force_n);
  }
  void clear_node_forces() { std::fill(applied_.begin(), applied_.end(), 0.0); }
  // Sets the velocity of a fixed node for the coming steps, until fix_nodes() is called.
  void move_fixed(int node, const Vector3& velocity_m_per_s) {
    put(fixed_velocity_, mesh_.joined(node), velocity_m_per_s);
    fixed_moves_ = true;
  }
  // Force of the cells and loads on a fixed node at the start of the last step, N.
  Vector3 force_on_fixed(int node) const { return at(force_, mesh_.joined(node)); }

  // Rayleigh quotient (v.Kv) / (v.Mv) of the free nodes' velocities v, with the scaled inertia M and the
  // tangent K of the last step; 0 at rest.
  double rayleigh_quotient();

  // Parts of a step, to be called in order. solve_velocities() computes the velocities at the end of the
  // step; `known_ns` are contact impulses, N s, by coordinate; for two joined nodes they must be at the first
  // node. respond_to() computes the velocity changes of the whole body due to further impulses, and returns
  // the dot product of these changes and the impulses, J. apply_response() adds `fraction` of these changes
  // to the velocities. move() advances the nodes and returns whether one reached the speed cap.
  ImplicitReport solve_velocities(const ImplicitStep& step, std::span<const double> known_ns = {});
  double respond_to(const std::vector<double>& impulses);
  void apply_response(double fraction);
  bool move(double step_s);
  // Performs a whole step without contacts.
  ImplicitReport step(const ImplicitStep& step) {
    const ImplicitReport report = solve_velocities(step);
    move(step.step_s);
    return report;
  }

  // Visits the state that the next step starts from.
  template <class Visitor>
  void visit_state(Visitor&& visit) const {
    for (const Doubles* a : {&moved_, &velocity_, &applied_}) visit(a->data(), a->size());
    if (!has_fixed_nodes_) visit(frame_.coeffs().data(), 4);
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
  void add_cells(const BlockMaterials& materials);
  void set_damping_time(const BlockMaterials& materials);
  void free_only(Doubles& of) const;

  struct RigidMotion {
    Vector3 centre_m = Vector3::Zero(), velocity_m_per_s = Vector3::Zero(), spin_rad_per_s = Vector3::Zero();

    Vector3 velocity_at(const Vector3& position_m) const {
      return velocity_m_per_s + spin_rad_per_s.cross(position_m - centre_m);
    }
  };
  Vector3 deformed_position(int node) const {
    return mesh_.nodes[static_cast<std::size_t>(node)] + displacement(node);
  }
  // Mass, centre and inertia tensor of a free body at the start of the step.
  struct RigidInertia {
    double mass_kg = 0.0;
    Vector3 centre_m = Vector3::Zero();
    Eigen::Matrix3d tensor_kg_m2 = Eigen::Matrix3d::Zero();
  };
  void update_inertia();
  // rigid_motion() returns the rigid motion with the sum and the moment of the nodes' momenta, N s, which
  // `momentum_ns(node)` returns. rigid_part() returns that of velocities, which are by coordinate.
  template <class Momenta>
  RigidMotion rigid_motion(const Momenta& momentum_ns) const;
  RigidMotion rigid_part(const Doubles& velocities) const;
  void set_rigid_part(const RigidMotion& motion, Doubles& velocities) const;
  bool cap_speeds(const RigidMotion& motion, double cap_m_per_s);
  void move_and_turn(const RigidMotion& motion, double step_s);
  void precondition(const Doubles& from, Doubles& to);
  void apply_matrix(double inertia, double stiffness, const Doubles& field, Doubles& out) const;
  void apply_fixed_motion(double stiffness, double h);
  void begin_solve(double inertia, double stiffness, double h);
  ImplicitReport solve(double inertia, double stiffness);

  LatticeMesh mesh_;
  LatticeReport report_;
  const BandKernels* band_;
  const CellKernels* cells_;
  double damping_time_ = 0.0, inertia_scale_ = 1.0, cell_size_;
  int size_;  // number of coordinates
  bool has_fixed_nodes_ = false, fixed_moves_ = false;
  RigidInertia inertia_;
  Quaternion frame_ = Quaternion::Identity();  // rotation of a free body since the last fix_nodes()
  RigidMotion motion_;                         // of a free body at the end of the step
  RollingFactor factor_;
  CellBlock block_;
  // mass_ is by node; mass3_ is by coordinate, 0 if fixed; free_ is by coordinate, 1 if free and 0 if fixed.
  Doubles mass_, mass3_, free_;
  Doubles moved_, velocity_, applied_;
  Doubles fixed_velocity_;  // prescribed velocities of fixed nodes; 0 for free nodes
  Doubles force_, residual_, direction_, image_, conditioned_, in_frame_;  // working memory
};

}  // namespace spoonbill
