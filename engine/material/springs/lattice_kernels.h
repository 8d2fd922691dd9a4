// The inner loops of the spring lattice, compiled once for each instruction set and chosen at start. Every
// set gives the same bits: lanes run over nodes, sums run in a fixed order, nothing is contracted. This
// header and its source use no standard library, as engine/bspline/evaluate_kernels.h explains.
//
// Arrays are structures of arrays over nodes in the mesh's order, padded with zeros so that every loop runs
// over whole blocks and every neighbour offset stays inside. A spring is stored at its first node, once for
// each of the 13 directions of a regular lattice; a cell at its first corner. Where none exists its stiffness
// is zero.
#pragma once

namespace spoonbill {

inline constexpr int lattice_block = 64;  // nodes a block; the order of sums depends on it, so it is fixed
inline constexpr int lattice_direction_count = 13;

// The springs of one direction, linearised: with a the vector from a node to its neighbour at the reference,
// a spring pulls its node by transverse * m + axial * (a.m) a where its ends move apart by m. A block's
// numbers lie together, five runs: a's x, y and z in m, axial in N/m^3 and transverse in N/m.
inline constexpr int tangent_runs = 5;

// The springs of one direction.
struct SpringArrays {
  int offset = 0;                 // from a node to its neighbour, positive
  const float* rest_x = nullptr;  // the vector to the neighbour in the rest shape, m
  const float* rest_y = nullptr;
  const float* rest_z = nullptr;
  const float* stiffness = nullptr;          // N/m
  float* rest_length = nullptr;              // m; changed by flow and reforming
  float* square_difference = nullptr;        // |rest vector|^2 - rest_length^2, m^2; exactly 0 until then
  const float* first_rest_length = nullptr;  // as built, m
  float* crept = nullptr;                    // the strain of the rest length that creep() made
  float* tangent = nullptr;                  // see tangent_runs
  // Of lattices whose springs differ in them; else null. Springs that do not flow have a flow rate of 0,
  // those that do not creep a share of 0.
  const float* stiffening = nullptr;
  const float* further_damping = nullptr;  // N s/m, see damp_further()
  const float* yield = nullptr;
  const float* hardening = nullptr;
  const float* flow_rate = nullptr;  // 1/s
  const float* relaxing_fraction = nullptr;
  const float* relaxation_time = nullptr;  // s
};

// How rest lengths yield: past a strain e of `yield`, more where a spring has yielded already, by `rate_step`
// of what is beyond it. Where springs differ, each has its own, and `rate_step` is its flow rate times
// `time_s`.
struct FlowRule {
  float yield = 0.0f;
  float hardening = 0.0f;  // of the yield strain, by |L0 / first L0 - 1|
  float rate_step = 0.0f;  // at most largest_flow_step
  float time_s = 0.0f;
};

// Of the strain beyond yield that one flow may take away: the rest of it stays for the next.
inline constexpr double largest_flow_step = 0.5;

// How rest lengths creep: towards `share` of the strain, by `rate_step` of the way. Where springs differ,
// each has its own, and `rate_step` follows from `time_s`.
struct CreepRule {
  float share = 0.0f;
  float rate_step = 0.0f;  // 1 / (1 + relaxation time / time_s)
  float time_s = 0.0f;
};

// Views of arrays that SpringLattice owns.
struct LatticeView {
  int padded_count = 0;           // nodes, a whole number of blocks
  float stiffening = 0.0f;        // see linearise_springs(); the largest where springs differ
  bool volume_gives_way = false;  // whether any K_v is below zero, see volume_forces()
  float *dx = nullptr, *dy = nullptr, *dz = nullptr;  // displacement from the rest shape, m
  float *vx = nullptr, *vy = nullptr, *vz = nullptr;  // m/s
  float *fx = nullptr, *fy = nullptr, *fz = nullptr;  // N
  // Where nodes will be after the damping time at their present velocity: d + tau v, m. Forces taken there
  // are damped: f(x + tau v) is f(x) + tau df/dt, a Voigt element each spring and cell.
  float *ahead_x = nullptr, *ahead_y = nullptr, *ahead_z = nullptr;
  float *reference_x = nullptr, *reference_y = nullptr,
        *reference_z = nullptr;                                         // the same, when linearised, m
  float *moved_x = nullptr, *moved_y = nullptr, *moved_z = nullptr;     // since then, m
  float *spring_x = nullptr, *spring_y = nullptr, *spring_z = nullptr;  // the springs' forces then, N
  const float* inverse_mass = nullptr;                                  // 1/kg; 0 where held
  const float* free_node = nullptr;  // 1 where free, 0 where held or padding
  // Pairs of nodes that are one place (LatticeMesh::closed), first the one that stands for both: what acts on
  // either acts on both, and where they move they move together.
  const int* seam = nullptr;
  int seam_count = 0;
  // One a block: 0 where no spring or cell that starts there has a free node. Forces leave such blocks out,
  // and are then those on free nodes alone.
  const unsigned char* active_block = nullptr;
  const unsigned char* free_block = nullptr;  // one a block: 0 where no node is free, so that none moves
  SpringArrays springs[lattice_direction_count];
  int corner_offset[8] = {};                 // from a cell's first corner, bit 0 = k, bit 1 = j, bit 2 = i
  int corner_direction[8] = {};              // the spring direction from the first corner to each; [0] unused
  const float* bulk_stiffness = nullptr;     // K_v V0, J
  const float* crushed_stiffness = nullptr;  // of a cell that is crushed, J; see volume_forces()
  const float* inverse_volume = nullptr;     // 1/V0, 1/m^3
  float* rest_volume_sum = nullptr;  // 12 V0 as volume_forces() computes it, so that rest has no strain at
                                     // all; reforming changes it
  const float* further_bulk_damping = nullptr;  // by cell, J s, see damp_further(); null where there is none
  const float* has_cell = nullptr;              // 1 or 0
  const float* inverse_cell_count = nullptr;    // of the cells around a node
  float* node_dilation = nullptr;               // working memory of flow(): J averaged over them
  float* power_x = nullptr;                     // the vector of the running power iteration
  float* power_y = nullptr;
  float* power_z = nullptr;
  const float* power_noise = nullptr;  // keeps every mode present in it
};

// How the nodes move in a substep.
struct Drift {
  float h_s = 0.0f;
  float cap_m_per_s = 0.0f;
  float mean_x = 0.0f, mean_y = 0.0f, mean_z = 0.0f;  // m/s; the cap is on speeds relative to it
  float tau_s = 0.0f;
};

struct Drifted {
  float speed_square = 0.0f;  // the largest, over the cap's
  float moved_square = 0.0f;  // the largest since the springs were linearised, m^2
};

// What a linearisation keeps: the springs' forces alone, for where no substep follows on it, or their
// derivatives beside them.
enum class Linearised { forces, tangents };

struct LatticeKernels {
  // Places nodes ahead by the damping time tau.
  void (*look_ahead)(const LatticeView&, float tau_s);
  // Takes the present as the reference: F = k (L - L0) s n of every spring, ahead in time, and its
  // derivative. With the strain e = L / L0 - 1 and a stiffening b, s = 1 + b e^2 up to 2 where b > 0,
  // s = (1 - b e^2)^(-1/2) where b < 0, and 1 where it is 0: softening springs pull ever more weakly, and
  // still the more the longer they are, so that no lattice of them snaps.
  // Eq. 7 of Pungotra et al. 2013 damps the whole velocity, and so a rotation; ahead of a rotating body there
  // is the same body turned further, so that this does not.
  void (*linearise_springs)(const LatticeView&, Linearised kept);
  // Sets the forces to the springs' at the reference.
  void (*start_forces)(const LatticeView&);
  // Adds what the springs' forces changed by since, to first order. This, damp_further() and power_step()
  // want the tangents kept.
  void (*spring_forces)(const LatticeView&);
  // f = -p dV/dx, p = K_v x, x = J - 1, ahead in time, with the exact volume of each trilinear cell. Below
  // Poisson's ratios of 1/4 K_v is negative, and this energy unbounded below: there
  // p = K_v x / (1 + (x / 0.1)^2), which the springs outlast. A cell crushed below 0.3 of its volume pushes
  // back by crushed_stiffness beside that: to springs a cell inside out is as good as one that is not.
  void (*volume_forces)(const LatticeView&);
  // Adds the damping that springs and cells have beyond the time that look_ahead() takes: c ((v' - v).n) n of
  // a spring along n at the reference, and the pressure c J' of a cell, as rates of its volume now.
  void (*damp_further)(const LatticeView&);
  // v = (v + h (f/m + g)) * decay, with the forces on a seam's pairs added up.
  void (*kick)(const LatticeView&, float h_s, float decay, float gx, float gy, float gz);
  // Caps speeds relative to the mean, then d += h v, and looks ahead; the second of a seam's pair at the
  // first's velocity.
  Drifted (*drift)(const LatticeView&, const Drift&);
  // Mass-weighted sums of velocity over free nodes; masses enter as given. sum[4]: x, y, z, mass.
  void (*momentum)(const LatticeView&, const float* mass, float sum[4]);
  // L0 += rate_step * (|e| - yield) sign(e) L0, e = L / (L0 J^(1/3)) - 1, L0 within 1/2 to 2 of its first
  // value; none about a node whose cells are crushed or torn (J outside 0.3 to 3).
  void (*flow)(const LatticeView&, const FlowRule&);
  // The springs of one direction: q += rate_step * (share * e - q) for the part q of the rest length
  // L0 = L00 (1 + q) that is crept, e = L / (L00 J^(1/3)) - 1, within the same bounds. At a constant strain
  // the stress falls by `share` of itself, as in a standard linear solid; a share of 1 leaves none.
  void (*creep)(const LatticeView&, int direction, const CreepRule&);
  // Gershgorin's bound on each node's share of the stiffness: 2 k a spring, K_v/V0 |g_i| sum |g_j| a cell.
  // Never below the largest eigenvalue of its rows; 1.4 to 1.9 times too careful for a whole lattice.
  void (*row_sums)(const LatticeView&, float* sum_n_per_m);
  // Fills rest_volume_sum from the present shape.
  void (*measure_rest_volumes)(const LatticeView&);
  // One step w <- M^-1 K w of the power iteration, normalised, K linearised. Returns |M^-1 K w| / |w| in the
  // mass norm, an estimate of the largest omega^2. Uses the force arrays as working memory.
  float (*power_step)(const LatticeView&, const float* mass);
  // linearise_springs() and then power_step(), with the same results, in one passage over the springs.
  float (*linearise_with_power_step)(const LatticeView&, Linearised kept, const float* mass);
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
