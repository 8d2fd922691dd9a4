// Inner loops of the spring lattice, compiled once for each instruction set and chosen at start. Every set
// gives the same bits: SIMD lanes run over nodes, sums run in a fixed order, and products are never fused
// with sums. This header and its sources use no standard library; engine/bspline/evaluate_kernels.h explains
// why.
//
// Data are structures of arrays over nodes in the mesh's order. They are padded with zeros, so that every
// loop runs over whole blocks and the neighbours of every node are within the arrays. A spring is stored at
// its first node, once for each of the 13 directions of a regular lattice; a cell is stored at its first
// corner. Entries without a spring or cell have zero stiffness.
#pragma once

namespace spoonbill {

inline constexpr int lattice_block = 64;  // nodes per block; fixed, because the order of sums depends on it
inline constexpr int lattice_direction_count = 13;

// Number of floats that a linearisation stores per spring. Let a be the vector from a node to its neighbour
// at the linearisation. When the ends of the spring move apart by d, the spring's pull on the node grows by
// transverse * d + axial * (a.d) a. Each block of nodes stores five arrays: the x, y and z components of a
// (metres), axial (N/m^3) and transverse (N/m).
inline constexpr int tangent_runs = 5;

// Springs of one direction, one entry per node.
struct SpringArrays {
  int offset = 0;                 // index of the neighbour minus index of the node; positive
  const float* rest_x = nullptr;  // vector to the neighbour in the rest shape, m
  const float* rest_y = nullptr;
  const float* rest_z = nullptr;
  const float* stiffness = nullptr;    // N/m
  float* rest_length = nullptr;        // m; changed by flow, creep and reform()
  float* square_difference = nullptr;  // |rest vector|^2 - rest_length^2, m^2; exactly 0 in a new lattice
  const float* first_rest_length = nullptr;  // rest length at construction, m
  float* crept = nullptr;                    // strain of the rest length due to creep()
  float* tangent = nullptr;                  // linearisation, see tangent_runs
  // If the materials of the lattice differ in a property, its array has one value for each spring; otherwise
  // it is null. The flow rate is 0 for springs that do not flow, and relaxing_fraction is 0 for springs that
  // do not creep.
  const float* stiffening = nullptr;
  const float* further_damping = nullptr;  // N s/m, see damp_further()
  const float* yield = nullptr;
  const float* hardening = nullptr;
  const float* flow_rate = nullptr;  // 1/s
  const float* relaxing_fraction = nullptr;
  const float* relaxation_time = nullptr;  // s
};

// Plastic flow of rest lengths: each step removes the fraction `rate_step` of the strain beyond the yield
// strain. The yield strain grows with the strain already yielded. If the materials differ, each spring has
// its own yield strain and hardening, and its rate step is its flow rate times `time_s`, at most
// largest_flow_step.
struct FlowRule {
  float yield = 0.0f;
  float hardening = 0.0f;  // added yield strain per |L0 / first L0 - 1|
  float rate_step = 0.0f;  // at most largest_flow_step
  float time_s = 0.0f;
};

// Largest fraction of the strain beyond yield that one flow step removes.
inline constexpr double largest_flow_step = 0.5;

// Creep of rest lengths: the creep strain approaches `fraction` times the strain, and each step reduces the
// difference by the fraction `rate_step`. If the materials differ, each spring has its own fraction and
// relaxation time, and its rate step follows from `time_s`.
struct CreepRule {
  float fraction = 0.0f;
  float rate_step = 0.0f;  // 1 / (1 + relaxation time / time_s)
  float time_s = 0.0f;
};

struct MovingFrame;   // see engine/material/lattice/embedded_point.h
class RigidDynamics;  // see engine/material/rigid/rigid_dynamics.h

// Limit of the speeds of nodes, relative to a velocity.
struct SpeedCap {
  float cap_m_per_s = 0.0f;                           // in LatticeView::damped_speeds, 0 means no limit
  float mean_x = 0.0f, mean_y = 0.0f, mean_z = 0.0f;  // m/s
};

// View of arrays that a SpringLattice owns.
struct LatticeView {
  int padded_count = 0;         // number of nodes including padding, a whole number of blocks
  float stiffening = 0.0f;      // see linearise_springs(); the largest value where springs differ
  bool volume_softens = false;  // true if any K_v is negative, see volume_forces()
  float *dx = nullptr, *dy = nullptr, *dz = nullptr;  // displacement from the rest shape, m
  float *vx = nullptr, *vy = nullptr, *vz = nullptr;  // m/s, relative to `frame` if there is one
  float *fx = nullptr, *fy = nullptr, *fz = nullptr;  // N
  // Extrapolated node displacements d + tau v at the last linearisation, m, where tau is the damping time.
  // Spring forces evaluated there are damped: f(x + tau v) is f(x) + tau df/dt to first order, as in a
  // Kelvin-Voigt element.
  float *reference_x = nullptr, *reference_y = nullptr, *reference_z = nullptr;
  SpeedCap damped_speeds;  // limit of the speeds v with which displacements are extrapolated
  // Change of the extrapolated displacements since the linearisation, m.
  float *moved_x = nullptr, *moved_y = nullptr, *moved_z = nullptr;
  // Spring forces at the linearisation, N.
  float *spring_x = nullptr, *spring_y = nullptr, *spring_z = nullptr;
  const float* inverse_mass = nullptr;  // 1 / inertia, 1/kg; 0 for fixed nodes
  // Weight of the springs' stiffness in power steps and row sums: 1 + 2 tau / h for substeps of h, because
  // h^2 K + 2 h tau K limits the stable substep of damped springs.
  float spring_weight = 1.0f;
  const float* free_node = nullptr;  // 1 for free nodes, 0 for fixed nodes and padding
  // Pairs of nodes that coincide (LatticeMesh::closed). The first of a pair is the representative. A force on
  // one node of a pair acts on both, and both move together.
  const int* seam = nullptr;
  int seam_count = 0;
  // Per block: 0 if no spring or cell that starts in the block has a free node. Force kernels skip such
  // blocks, so only the forces on free nodes are complete.
  const unsigned char* active_block = nullptr;
  const unsigned char* free_block = nullptr;  // per block: 0 if every node is fixed
  SpringArrays springs[lattice_direction_count];
  int corner_offset[8] = {};     // index of a corner minus that of the first; bit 0 = k, bit 1 = j, bit 2 = i
  int corner_direction[8] = {};  // spring direction from the first corner to each other corner; [0] is unused
  const float* bulk_stiffness = nullptr;     // K_v V0 of each cell, J; see volume_forces()
  const float* crushed_stiffness = nullptr;  // additional stiffness of a crushed cell, J; see volume_forces()
  const float* inverse_volume = nullptr;     // 1 / V0 with the volume V0 at construction, 1/m^3
  // 12 times the rest volume of each cell, m^3, computed as in volume_forces(), so that the rest shape has
  // exactly zero dilation. It is 12 V0 until reform() changes it.
  float* rest_volume_sum = nullptr;
  const float* has_cell = nullptr;            // 1 at the first corner of a cell, otherwise 0
  const float* inverse_cell_count = nullptr;  // 1 / the number of cells around a node
  float* node_dilation = nullptr;             // working memory of flow(): mean J of the cells around a node
  float* power_x = nullptr;                   // vector of the power iteration
  float* power_y = nullptr;
  float* power_z = nullptr;
  // Added to the vector of the power iteration at each step, so that no mode vanishes from it.
  const float* power_noise = nullptr;
  MovingFrame* frame = nullptr;    // frame of a soft tool; null for other lattices
  RigidDynamics* rigid = nullptr;  // motion of a rigid body that contacts can move; null for other lattices
};

// Parameters of one drift of the nodes.
struct Drift {
  float h_s = 0.0f;
  SpeedCap speeds;
  float tau_s = 0.0f;
};

// Results of one drift.
struct Drifted {
  float speed_square = 0.0f;  // largest squared ratio of speed to cap
  float moved_square = 0.0f;  // largest squared change of d + tau v since the linearisation, m^2
};

// The smallest and the largest value of a nodal field, and whether the sum of its values is finite. It is not
// if a value is not finite, or if very large values overflow it.
struct FieldRange {
  float low, high;
  bool has_finite_sum;
};

// Results that a linearisation stores: only the spring forces, which suffice if no further substep uses the
// linearisation, or the forces and their derivatives.
enum class Linearised { forces, tangents };

struct LatticeKernels {
  // Linearises the springs at the positions extrapolated by the damping time tau: computes the force
  // F = k (L - L0) s n of every spring with the direction n, and its derivative. s depends on the strain
  // e = L / L0 - 1 and the stiffening b:
  // s = 1 + b e^2, at most 2, for b > 0; s = (1 - b e^2)^(-1/2) for b < 0; and s = 1 for b = 0. The force
  // of a softening spring still grows with its length.
  //
  // Eq. 7 of Pungotra et al. 2013 damps the whole velocity, rotations included. Here rotations are not
  // damped, because the extrapolation of a rotating body is the same body rotated further.
  void (*linearise_springs)(const LatticeView&, float tau_s, Linearised stored);
  // Stores the tangents of the last linearisation. Its forces stay the same if nothing has changed the
  // positions at which the springs were linearised.
  void (*store_tangents)(const LatticeView&);
  // Sets the forces to the spring forces of the linearisation.
  void (*start_forces)(const LatticeView&);
  // Adds the first-order change of the spring forces since the linearisation. This function, damp_further()
  // and power_step() need Linearised::tangents.
  void (*spring_forces)(const LatticeView&);
  // Adds the weights of all nodes under the gravity g, m/s^2.
  void (*add_weights)(const LatticeView&, const float* mass, const float g[3]);
  // Adds the force f = -p dV/dx of each cell's pressure p on its corners x, with the exact volume V of the
  // trilinear cell. The pressure is p = K_v q for the dilation q = J - 1. Changes of volume are not damped:
  // damping these fast modes would need ten times the substeps.
  //
  // For Poisson's ratios below 1/4, K_v is negative, and this pressure would make the energy unbounded below.
  // The pressure is then p = K_v q / (1 + (q / 0.1)^2), which the springs outweigh. A cell below 0.3 of its
  // rest volume also pushes back with crushed_stiffness, because springs cannot tell an inverted cell from a
  // regular one.
  void (*volume_forces)(const LatticeView&);
  // Sets flat[n] to 1 for each cell, by its first corner n, of which the three edges at a corner span less
  // than `ratio` of their volume at rest, and to 0 for all others, padding included. Corners that span less
  // than `least` of the cell's volume at construction are left out. Returns whether there is such a cell.
  bool (*find_flat_cells)(const LatticeView&, float ratio, float least, unsigned char* flat);
  // Adds the damping of springs beyond the damping time of the linearisation. A spring with the further
  // damping c, the direction n at the linearisation and the end velocities v and v' exerts the force
  // c ((v' - v).n) n on its first end and the opposite force on the other.
  void (*damp_further)(const LatticeView&);
  // Sets v = v * decay + h f / m, after adding the forces of each seam pair. The decay does not apply to the
  // new impulse h f / m, so that drag does not change the equilibrium of a body at rest.
  void (*kick)(const LatticeView&, float h_s, float decay);
  // Caps speeds relative to the mean velocity of `Drift`, sets d += h v and extrapolates the displacements by
  // the damping time. The second node of a seam pair gets the velocity of the first.
  Drifted (*drift)(const LatticeView&, const Drift&);
  // Computes mass-weighted sums of velocity over free nodes: sum = {x, y, z, mass}. `mass` must be 0 for
  // fixed nodes.
  void (*momentum)(const LatticeView&, const float* mass, float sum[4]);
  // Finds the range of `count` values, at least one.
  FieldRange (*find_range)(const float* field, int count);
  // Finds the largest x^2 + (y^2 + z^2) of the vectors of a nodal field. `padded_count` is a multiple of
  // lattice_block.
  double (*find_largest_square)(const float* x, const float* y, const float* z, int padded_count);
  // Flows the springs: sets L0 += rate_step * (|e| - yield) sign(e) L0 where the strain
  // e = L / (L0 J^(1/3)) - 1 is beyond yield. J is the mean volume ratio of the cells around the spring's
  // ends. L0 changes by at most a tenth in a step and stays within 1/2 to 2 of its initial value. Springs at
  // a node whose cells are crushed or torn (J outside 0.3 to 3) do not flow.
  void (*flow)(const LatticeView&, const FlowRule&);
  // Creeps the springs of one direction: sets q += rate_step * (fraction * e - q) for the creep strain q in
  // the rest length L0 = L00 (1 + q). The strain is e = L / (L00 J^(1/3)) - 1, and L0 and J are bounded as in
  // flow(). At constant strain the stress falls by `fraction` of itself, as in a standard linear solid.
  void (*creep)(const LatticeView&, int direction, const CreepRule&);
  // Computes Gershgorin's row sums of the weighted stiffness by node. A spring adds 2 k times its weight, or
  // 8 k if springs stiffen. A cell adds K_v/V0 |g_i| sum |g_j| at corner i, with the gradients g of its
  // volume. The largest sum bounds the largest eigenvalue from above; for a whole lattice it is 1.4 to 1.9
  // times as large.
  void (*row_sums)(const LatticeView&, float* sum_n_per_m);
  // Sets rest_volume_sum from the present shape.
  void (*measure_rest_volumes)(const LatticeView&);
  // Performs one normalised step w <- M^-1 K w of the power iteration. K is the linearised stiffness, in
  // which the springs count spring_weight times, and M is the inertia. Returns |M^-1 K w| / |w| in the norm
  // of `mass`, an estimate of the square of the largest angular frequency. Overwrites the forces.
  float (*power_step)(const LatticeView&, const float* mass);
  // Performs linearise_springs() and then power_step() in one pass over the springs, with the same results.
  float (*linearise_with_power_step)(const LatticeView&, float tau_s, Linearised stored, const float* mass);
};

namespace kernels_baseline {
extern const LatticeKernels lattice_kernels;
}
namespace kernels_avx2 {
extern const LatticeKernels lattice_kernels;
}
namespace kernels_avx512 {
extern const LatticeKernels lattice_kernels;
}

}  // namespace spoonbill

#ifdef SPOONBILL_KERNELS
// Parts of the kernels of one instruction set, shared by the sources of this folder. Functions without a
// comment are described at the members of LatticeKernels with the same names.
namespace spoonbill::SPOONBILL_KERNELS {

// Adds the two values of a nodal field at each seam pair and gives both nodes the sum.
void join_seam(const LatticeView& view, float* field);
void join_seam_forces(const LatticeView& view);

void kick(const LatticeView& view, float h_s, float decay);
Drifted drift(const LatticeView& view, const Drift& drift);
void momentum(const LatticeView& view, const float* mass, float sum[4]);
FieldRange find_range(const float* field, int count);
double find_largest_square(const float* x, const float* y, const float* z, int padded_count);

void flow(const LatticeView& view, const FlowRule& rule);
void creep(const LatticeView& view, int direction, const CreepRule& rule);

// See LatticeKernels::volume_forces.
void volume_forces(const LatticeView& view);

// See LatticeKernels::find_flat_cells.
bool find_flat_cells(const LatticeView& view, float ratio, float least, unsigned char* flat);

// Sets node_dilation to the mean J of the cells around each node.
void average_dilations(const LatticeView& view);

// Adds each cell's contribution to the row sums, N/m.
void add_volume_row_sums(const LatticeView& view, float* sum_n_per_m);

// Subtracts K w from the forces: K is the volume stiffness at the present positions, and w the vector of the
// power iteration.
void subtract_volume_stiffness(const LatticeView& view);

// See LatticeKernels::measure_rest_volumes.
void measure_rest_volumes(const LatticeView& view);

}  // namespace spoonbill::SPOONBILL_KERNELS
#endif
