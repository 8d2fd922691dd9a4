#include "engine/material/lattice_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/material/springs/lattice_forces.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {
namespace {

// Returns the moving support that fixes all fixed nodes of the lattice, or null.
const SupportedNodes* find_common_support(std::span<const SupportedNodes> supports,
                                          const SpringLattice& lattice) {
  const SupportedNodes* only = nullptr;
  for (const SupportedNodes& support : supports) {
    if (support.nodes.empty()) continue;
    if (only != nullptr || !support.moves) return nullptr;
    only = &support;
  }
  const bool has_all = only != nullptr && static_cast<int>(only->nodes.size()) == lattice.fixed_count();
  return has_all ? only : nullptr;
}

Vector3 support_velocity(const SupportedNodes& support, double time_s) {
  return (support.end_m - support.start_m) / time_s;
}

// Shortens displacements of supports that are too long for one tick. `reach_m` is the distance that the speed
// cap allows in the tick. If one support fixes all fixed nodes, the whole lattice moves with it. This support
// may move by `reach_m` or twice its largest_step_m, whichever is more, so that it can catch up after a
// stroke is undone. Returns true if a displacement was shortened.
bool limit_support_motion(std::span<SupportedNodes> supports, const SpringLattice& lattice, double reach_m) {
  SPOONBILL_ASSERT(reach_m >= 0.0);
  const SupportedNodes* const common = find_common_support(supports, lattice);
  bool limited = false;
  for (SupportedNodes& support : supports) {
    if (!support.moves) continue;
    const double most = &support == common ? std::max(reach_m, 2.0 * support.largest_step_m) : reach_m;
    const Vector3 displacement = support.end_m - support.start_m;
    const double length = displacement.norm();
    if (!(length > most)) continue;
    support.end_m = support.start_m + most / length * displacement;
    limited = true;
  }
  return limited;
}

// Returns the velocity of the support that moves the whole lattice, m/s; zero if no support does.
Vector3 common_support_velocity(std::span<const SupportedNodes> supports, const SpringLattice& lattice,
                                double time_s) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  const SupportedNodes* const common = find_common_support(supports, lattice);
  return common ? support_velocity(*common, time_s) : Vector3::Zero();
}

// Sets the velocities of supported nodes. Call after the kick, which sets the velocities of all fixed nodes
// to zero.
void set_support_velocities(std::span<const SupportedNodes> supports, const LatticeView& view,
                            double time_s) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  for (const SupportedNodes& support : supports) {
    if (!support.moves) continue;
    const Vector3 velocity = support_velocity(support, time_s);
    for (const int n : support.nodes) set_velocity(view, n, velocity);
  }
}

// Adds the impulse of each support on the body in a substep of h_s to the support's impulse_ns. Call after
// the forces are computed.
void add_support_impulses(std::span<SupportedNodes> supports, const LatticeView& view, double h_s) {
  for (SupportedNodes& support : supports) {
    Vector3 force = Vector3::Zero();
    for (const int n : support.nodes) force -= Vector3(view.fx[n], view.fy[n], view.fz[n]);
    support.impulse_ns += h_s * force;
  }
}

// Moves supported nodes to `fraction` of the support's displacement in the tick. Call after the drift.
// Returns the largest squared change of an extrapolated node displacement since the linearisation, m^2.
float move_supported_nodes(std::span<const SupportedNodes> supports, const LatticeView& view, double fraction,
                           float damping_time_s) {
  float moved_square = 0.0f;
  for (const SupportedNodes& support : supports) {
    if (!support.moves) continue;
    const Vector3 displacement = support.start_m + fraction * (support.end_m - support.start_m);
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      const float square =
          set_node_displacement(view, support.nodes[i], support.base_m[i] + displacement, damping_time_s);
      moved_square = std::max(moved_square, square);
    }
  }
  return moved_square;
}

// Number of ticks from one creep step to the next. The creep of a single tick would be lost in the rounding
// of a rest length.
constexpr std::uint64_t creep_pause = 8;

struct Substeps {
  int count;
  bool slowed;
  int slowed_lattice = -1;
};

// Part of its step that a lattice may take in real time if nothing damps it. The longer step is in resonance
// with the fastest springs: three steps at h w = sqrt(3), four at sqrt(2), where the limit is 2 (Schlick,
// Mandziuk, Skeel and Srinivas 1998). Their energy then grows, unless they are damped.
constexpr double undamped_part = 0.5;

Substeps choose_substeps(const SpringLattice& lattice, const RelaxSettings& settings) {
  const int most = substep_ceiling * settings.substeps;
  const bool is_undamped = settings.is_real_time && !(lattice.damping_time_s() > 0.0f);
  const double fraction = is_undamped ? undamped_part * stability_fraction : stability_fraction;
  const double required = std::ceil(settings.time_s / lattice.stable_step_s(fraction));
  if (!(required <= most)) return {most, true};
  return {std::max(settings.substeps, static_cast<int>(required)), false};
}

// Returns the speed cap in real time, m/s (see speed_cap_cells), for substeps of `h` seconds.
float real_time_speed_cap(const SpringLattice& lattice, float h) {
  return lattice.cell_size_m() * static_cast<float>(speed_cap_cells) / h;
}

SpeedCap make_speed_cap(float cap_m_per_s, const Vector3& mean) {
  return {cap_m_per_s, static_cast<float>(mean.x()), static_cast<float>(mean.y()),
          static_cast<float>(mean.z())};
}

// Sets the speeds that damping follows in real time (see extrapolation_cap_cells).
void set_damped_speeds(const SpringLattice& lattice, const Vector3& mean, LatticeView& view) {
  const float cap = static_cast<float>(extrapolation_cap_cells) * lattice.cell_size_m();
  const float tau_s = lattice.damping_time_s();
  view.damped_speeds = make_speed_cap(tau_s > 0.0f ? cap / tau_s : 0.0f, mean);
}

// Returns the speed cap in m/s (see speed_cap_cells) for substeps of `h` seconds.
float speed_cap(const SpringLattice& lattice, float h) {
  const auto longest = static_cast<float>(2.0 / lattice.fastest_frequency());
  return static_cast<float>(speed_cap_cells) * lattice.cell_size_m() /
         std::max({h, longest, lattice.damping_time_s()});
}

// Limits the nodes' speeds relative to the velocity `mean` and moves the nodes.
Drifted drift(const SpringLattice& lattice, const LatticeView& view, float h, float cap,
              const Vector3& mean) {
  const Drift drift{h, make_speed_cap(cap, mean), lattice.damping_time_s()};
  return lattice.kernels().drift(view, drift);
}

// The lattices of one tick, with a view, a speed cap and a drag for each.
struct Relaxation {
  std::span<const RelaxedLattice> lattices;
  std::array<LatticeView, lattice_capacity> view;
  std::array<float, lattice_capacity> cap{};       // of the nodes' speeds, m/s
  std::array<float, lattice_capacity> push_cap{};  // of what contacts and supports prescribe, m/s
  std::array<Drifted, lattice_capacity> drifted{};
  std::array<LinearisedSprings, lattice_capacity> springs{};
  std::array<double, lattice_capacity> drag_per_s{};
  double time_s = 0.0;  // duration of the tick, s
  bool is_real_time = false;
  // Frame of the soft tool, if there is one, and the position at which it has moved the tool's lattice.
  MovingFrame frame;
  Vector3 frame_m = Vector3::Zero();

  std::size_t count() const { return lattices.size(); }
  // A lattice is moved by an implicit solver, as a rigid body, or by its springs.
  bool has_solver(std::size_t at) const { return lattices[at].implicit_solver != nullptr; }
  bool is_rigid(std::size_t at) const { return lattices[at].rigid_motion != nullptr; }
  RigidDynamics* dynamics(std::size_t at) const { return lattices[at].dynamics; }
  bool has_springs(std::size_t at) const { return !has_solver(at) && !is_rigid(at); }
  SpringLattice& lattice(std::size_t at) const { return *lattices[at].lattice; }
};

// One substep of a tick: its index, the number of substeps, and its duration h, s.
struct Substep {
  int index, count;
  float h;
  int parts;  // of the tick
};

// Gravity acts in at most this number of the substeps of a tick. With more and shorter substeps, rounding
// would swallow part of the velocity change of a falling node.
constexpr int most_weighted_substeps = 64;

// Returns the factor by which gravity is multiplied in a substep. It is 1 in a tick of at most
// most_weighted_substeps substeps. In a tick with more substeps, gravity acts in every n-th substep only, n
// times as strongly. The factors of a part of a tick add up to its number of substeps.
int count_weights(const Substep& substep) {
  const int most = std::max(1, most_weighted_substeps / substep.parts);
  const int stride = (substep.count + most - 1) / most;
  return substep.index % stride == 0 ? std::min(stride, substep.count - substep.index) : 0;
}

// Returns the target of the hand at the start of a substep. In a tick, the hand turns by so little that its
// orientation may be interpolated linearly.
HoldTarget find_hold_target(const RigidMotion& motion, const Vector3& rest_centre_m, double fraction,
                            double time_s) {
  const Pose &from = motion.start, &to = motion.end;
  const Vector3 start = from.position_m + from.orientation * rest_centre_m;
  const Vector3 end = to.position_m + to.orientation * rest_centre_m;
  const double sign = from.orientation.dot(to.orientation) < 0.0 ? -1.0 : 1.0;
  HoldTarget target;
  target.pose.orientation.coeffs() =
      (1.0 - fraction) * from.orientation.coeffs() + fraction * sign * to.orientation.coeffs();
  target.pose.orientation.normalize();
  target.pose.position_m = start + fraction * (end - start) - target.pose.orientation * rest_centre_m;
  target.velocity_m_per_s = (end - start) / time_s;
  target.spin_rad_per_s = 2.0 * sign / time_s * (to.orientation * from.orientation.conjugate()).vec();
  return target;
}

void kick_rigid_bodies(const Relaxation& relaxation, const Substep& substep) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    RigidDynamics* const dynamics = relaxation.dynamics(at);
    if (dynamics == nullptr) continue;
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    const HoldTarget target =
        find_hold_target(*relaxed.rigid_motion, dynamics->mass().centre_m,
                         static_cast<double>(substep.index) / substep.count, relaxation.time_s);
    dynamics->kick(static_cast<double>(substep.h), relaxed.gravity_m_per_s2, relaxation.drag_per_s[at],
                   relaxed.hand, target);
  }
}

void kick(Relaxation& relaxation, const Substep& substep) {
  const float h = substep.h;
  const int weights = count_weights(substep);
  kick_rigid_bodies(relaxation, substep);
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    const SpringLattice& lattice = relaxation.lattice(at);
    const LatticeView& view = relaxation.view[at];
    const float decay = 1.0f / (1.0f + h * static_cast<float>(relaxation.drag_per_s[at]));
    compute_forces(lattice, view, relaxation.drifted[at].moved_square,
                   weights * relaxation.lattices[at].gravity_m_per_s2, relaxation.springs[at]);
    if (relaxation.is_real_time) lattice.resist_inversion(view, h);
    add_support_impulses(relaxation.lattices[at].supports, view, static_cast<double>(h));
    lattice.kernels().kick(view, h, decay);
    set_support_velocities(relaxation.lattices[at].supports, view, relaxation.time_s);
  }
}

// Returns true if the tool has a constraint on a lattice of the given kind: one stepped explicitly by its
// springs, or rigid, if `springs` is true, otherwise one stepped by an implicit solver.
bool touches(const Relaxation& relaxation, const TouchingTool& tool, bool springs) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (relaxation.has_solver(at) != springs && tool.contacts->has_constraint_on(static_cast<int>(at))) {
      return true;
    }
  }
  return false;
}

// Number of passes over the contacts of implicitly stepped lattices in a tick.
constexpr int solver_passes = 2;

// Largest number of these passes in real time, where bodies may fall onto each other: the assumed contact
// mass may be far from how a body responds to a push on an edge.
constexpr int most_solver_passes = 16;

// Response of the implicitly stepped lattices to the impulses of contacts.
struct Response {
  ImplicitSolver::ContactResponse sum;
  std::array<bool, lattice_capacity> responds{};
};

Response find_response(const Relaxation& relaxation) {
  Response found;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_solver(at)) continue;
    const auto response = relaxation.lattices[at].implicit_solver->find_response(relaxation.lattice(at));
    found.responds[at] = response.work_j > 0.0;
    found.sum.assumed_work_j += response.assumed_work_j;
    found.sum.work_j += response.work_j;
  }
  return found;
}

void respond(const Relaxation& relaxation, const Response& response, double fraction) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!response.responds[at]) continue;
    relaxation.lattices[at].implicit_solver->respond(fraction, relaxation.lattice(at));
  }
}

// Solves the contacts of a tool with implicitly stepped lattices; does nothing if there are none.
void solve_with_solvers(const Relaxation& relaxation, const TouchingTool& tool, std::span<const float> caps) {
  if (!touches(relaxation, tool, false)) return;
  const std::span<const LatticeView> views(relaxation.view.data(), relaxation.count());
  for (int p = 0; p < solver_passes; ++p) {
    tool.contacts->pass(views, *tool.state, {relaxation.time_s, MovedBy::solvers, p % 2 == 1, caps});
    const Response response = find_response(relaxation);
    const double fraction = response.sum.find_best_fraction(tool.contacts->pass_work_j(*tool.state));
    respond(relaxation, response, fraction);
    tool.contacts->shorten_pass(*tool.state, fraction);
  }
}

// Solves the contacts between implicitly stepped lattices. Only the changes of the forces since the last tick
// may be scaled down. The forces of the last tick act in full (BodyContacts::visit_known_impulses()), so that
// an error of the assumed contact mass does not amplify them.
void solve_with_solvers(const Relaxation& relaxation, BodyContacts& between, std::span<const float> caps) {
  if (!between.has_constraint_between_solvers()) return;
  const std::span<const LatticeView> views(relaxation.view.data(), relaxation.count());
  const auto is_solved = [&] {
    return !relaxation.is_real_time || !between.are_approaching(views, MovedBy::solvers, relaxation.time_s);
  };
  for (int p = 0; p < solver_passes || (p < most_solver_passes && !is_solved()); ++p) {
    between.pass(views, {relaxation.time_s, MovedBy::solvers, p % 2 == 1, caps});
    const Response response = find_response(relaxation);
    const double fraction = response.sum.find_best_fraction(0.0);
    respond(relaxation, response, fraction);
    between.shorten_solver_pass(fraction);
  }
}

// Lets the implicitly stepped lattices respond to the contacts since their last response.
void respond_to_pairs(const Relaxation& relaxation, BodyContacts* between) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_solver(at)) continue;
    const int body = static_cast<int>(at);
    const double work_j = between ? between->find_assumed_work_j(body) : 0.0;
    const double fraction =
        relaxation.lattices[at].implicit_solver->respond_to_pairs(work_j, relaxation.lattice(at));
    if (between) between->respond(body, fraction, {relaxation.view.data(), relaxation.count()});
  }
}

// Solves the contacts of implicitly stepped lattices with bodies that move in substeps further, as long as
// bodies would approach each other with the velocities with which these lattices respond. Call before the
// last drift of a tick in real time.
void solve_with_responses(const Relaxation& relaxation, const Substep& substep, BodyContacts& between,
                          std::span<const float> caps) {
  const std::span<const LatticeView> views(relaxation.view.data(), relaxation.count());
  for (int p = 0; p < most_solver_passes; ++p) {
    respond_to_pairs(relaxation, &between);
    if (!between.are_approaching(views, MovedBy::springs, relaxation.time_s)) return;
    if (!between.pass(views, {static_cast<double>(substep.h), MovedBy::springs, p % 2 == 1, caps, true})) {
      return;
    }
  }
}

bool is_soft(const TouchingTool& tool) {
  return tool.motion.carried.body >= 0;
}

// Returns the soft tool, or null if all tools are rigid. At most one tool is soft.
const TouchingTool* find_soft_tool(std::span<const TouchingTool> tools) {
  const auto found = std::find_if(tools.begin(), tools.end(), is_soft);
  return found == tools.end() ? nullptr : &*found;
}

// Solves the contacts of a tool. Contacts with spring-stepped lattices are solved in each substep, contacts
// with implicitly stepped lattices once a tick.
void solve_tool(const Relaxation& relaxation, const TouchingTool& tool, const Substep& substep,
                std::span<const float> caps) {
  const std::span<const LatticeView> views(relaxation.view.data(), relaxation.count());
  const bool with_springs = is_soft(tool) || touches(relaxation, tool, true);
  if (!with_springs && substep.index > 0) return;
  const double h = with_springs ? static_cast<double>(substep.h) : relaxation.time_s;
  tool.contacts->start(views, *tool.state, h, static_cast<double>(substep.index) / substep.count);
  if (substep.index == 0) solve_with_solvers(relaxation, tool, caps);
  if (with_springs) {
    // A single pass favours the points that it solves last. A sphere on many points of one cell would then
    // shake the body for ever.
    for (const bool is_reversed : {false, true}) {
      tool.contacts->pass(views, *tool.state, {h, MovedBy::springs, is_reversed, caps});
    }
  }
  if (!is_soft(tool)) tool.contacts->finish(*tool.state, h);
}

// Moves the lattice of a soft tool by the motion of its frame in the substep. Call after the drift, which
// moves the free nodes within the frame. The nodes that the hand holds are set exactly, so that rounding does
// not add up.
void move_soft_tool(Relaxation& relaxation, const TouchingTool& tool) {
  const CarriedNodes& carried = tool.motion.carried;
  const auto at = static_cast<std::size_t>(carried.body);
  const SpringLattice& lattice = relaxation.lattice(at);
  const LatticeView& view = relaxation.view[at];
  shift_nodes(view, lattice.mesh().node_count(), tool.state->position_m - relaxation.frame_m);
  relaxation.frame_m = tool.state->position_m;
  for (const int n : carried.nodes) {
    const Vector3& rest = lattice.mesh().nodes[static_cast<std::size_t>(n)];
    const Vector3 moved = tool.state->position_m + tool.motion.orientation * rest - rest;
    const float square = set_node_displacement(view, n, moved, lattice.damping_time_s());
    relaxation.drifted[at].moved_square = std::max(relaxation.drifted[at].moved_square, square);
  }
}

// Returns the largest speed with which contacts may correct an overlap of each lattice.
std::array<float, lattice_capacity> find_push_caps(const Relaxation& relaxation) {
  std::array<float, lattice_capacity> caps{};
  for (std::size_t at = 0; at < relaxation.count(); ++at) caps[at] = 0.5f * relaxation.push_cap[at];
  return caps;
}

void solve_contacts(Relaxation& relaxation, const Substep& substep, std::span<const TouchingTool> tools,
                    BodyContacts* between, GroundContacts* ground) {
  const std::span<const LatticeView> views(relaxation.view.data(), relaxation.count());
  const std::array<float, lattice_capacity> push_caps = find_push_caps(relaxation);
  const auto h = static_cast<double>(substep.h);
  for (const TouchingTool& tool : tools) solve_tool(relaxation, tool, substep, push_caps);
  const TouchingTool* const soft = find_soft_tool(tools);
  if (soft) relaxation.frame = soft->contacts->frame(*soft->state);
  if (between) {
    if (substep.index == 0) solve_with_solvers(relaxation, *between, push_caps);
    between->start(views, h);
    for (const bool is_reversed : {false, true}) {
      between->pass(views, {h, MovedBy::springs, is_reversed, push_caps});
    }
    const bool is_last = substep.index + 1 == substep.count;
    if (is_last && relaxation.is_real_time) solve_with_responses(relaxation, substep, *between, push_caps);
  }
  if (soft) {
    soft->contacts->adopt(relaxation.frame, *soft->state);
    soft->contacts->finish(*soft->state, h);
  }
  if (!ground) return;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    ground->solve(static_cast<int>(at), relaxation.view[at], h, static_cast<double>(push_caps[at]));
  }
}

// Moves the supported nodes of all lattices to `fraction` of their supports' displacements in the tick.
void move_supported_nodes(Relaxation& relaxation, double fraction) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const float square = move_supported_nodes(relaxation.lattices[at].supports, relaxation.view[at], fraction,
                                              relaxation.lattice(at).damping_time_s());
    relaxation.drifted[at].moved_square = std::max(relaxation.drifted[at].moved_square, square);
  }
}

// Returns the displacement of a node of a rigid body whose rest position is `rest_m`.
Vector3 rigid_displacement(const Pose& pose, const Vector3& rest_m) {
  return pose.position_m + pose.orientation * rest_m - rest_m;
}

// Starts the tick of rigid bodies: sets the velocities of the nodes of those with a prescribed motion.
void begin_rigid_motions(Relaxation& relaxation) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.is_rigid(at)) continue;
    if (RigidDynamics* const dynamics = relaxation.dynamics(at)) {
      relaxation.view[at].rigid = dynamics;
      dynamics->place_nodes(relaxation.view[at]);
      continue;
    }
    const RigidMotion& motion = *relaxation.lattices[at].rigid_motion;
    const std::vector<Vector3>& nodes = relaxation.lattice(at).mesh().nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Vector3 moved =
          rigid_displacement(motion.end, nodes[n]) - rigid_displacement(motion.start, nodes[n]);
      set_velocity(relaxation.view[at], static_cast<int>(n), moved / relaxation.time_s);
    }
  }
}

// Moves rigid bodies by a substep. Nodes with a prescribed motion move along straight lines, as their
// velocities say.
void move_rigid_bodies(const Relaxation& relaxation, const Substep& substep) {
  const double fraction = static_cast<double>(substep.index + 1) / substep.count;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (RigidDynamics* const dynamics = relaxation.dynamics(at)) {
      dynamics->drift(relaxation.view[at], static_cast<double>(substep.h));
      continue;
    }
    if (!relaxation.is_rigid(at) || !relaxation.lattices[at].rigid_motion->moves) continue;
    const RigidMotion& motion = *relaxation.lattices[at].rigid_motion;
    const std::vector<Vector3>& nodes = relaxation.lattice(at).mesh().nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Vector3 start = rigid_displacement(motion.start, nodes[n]);
      const Vector3 end = rigid_displacement(motion.end, nodes[n]);
      set_node_displacement(relaxation.view[at], static_cast<int>(n), start + fraction * (end - start), 0.0f);
    }
  }
}

// Limits the motions of the supports and sets the velocities of their nodes. Returns true if a motion was
// limited.
bool begin_supports(Relaxation& relaxation) {
  bool limited = false;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    if (relaxed.supports.empty()) continue;
    const double reach_m = static_cast<double>(relaxation.push_cap[at]) * relaxation.time_s;
    limited |= limit_support_motion(relaxed.supports, *relaxed.lattice, reach_m);
    set_support_velocities(relaxed.supports, relaxation.view[at], relaxation.time_s);
  }
  return limited;
}

// Returns the velocity relative to which the speeds of a lattice's nodes are capped, m/s. It is zero for a
// soft tool, whose velocities are relative to the tool already.
Vector3 find_mean_velocity(const Relaxation& relaxation, std::size_t at) {
  const SpringLattice& lattice = relaxation.lattice(at);
  if (lattice.has_fixed_nodes()) {
    return common_support_velocity(relaxation.lattices[at].supports, lattice, relaxation.time_s);
  }
  float sum[4];
  lattice.kernels().momentum(relaxation.view[at], lattice.free_mass(), sum);
  const float inverse = sum[3] > 0.0f ? 1.0f / sum[3] : 0.0f;
  return Vector3(sum[0] * inverse, sum[1] * inverse, sum[2] * inverse);
}

// Restores the momentum that capping took from a body without fixed nodes. Otherwise an unevenly pressed body
// would be propelled by its own speed cap.
void restore_momentum(const SpringLattice& lattice, const LatticeView& view, const Vector3& mean) {
  float sum[4];
  lattice.kernels().momentum(view, lattice.free_mass(), sum);
  if (!(sum[3] > 0.0f)) return;
  const Vector3 lost = mean - Vector3(sum[0], sum[1], sum[2]) / sum[3];
  for (int n = 0; n < view.padded_count; ++n) {
    set_velocity(view, n, Vector3(view.vx[n], view.vy[n], view.vz[n]) + view.free_node[n] * lost);
  }
}

// Moves an implicitly stepped lattice at its present velocities, so that the contacts of later substeps are
// solved at its later positions.
void drift_with_solver(const LatticeView& view, float h) {
  for (int i = 0; i < view.padded_count; ++i) {
    view.dx[i] += h * view.vx[i] * view.free_node[i];
    view.dy[i] += h * view.vy[i] * view.free_node[i];
    view.dz[i] += h * view.vz[i] * view.free_node[i];
  }
}

// Moves the nodes of all lattices. Returns the index of a lattice of which a node reached the speed cap, or
// -1.
int drift(Relaxation& relaxation, float h, bool is_real_time) {
  int capped = -1;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (relaxation.has_solver(at)) drift_with_solver(relaxation.view[at], h);
    if (!relaxation.has_springs(at)) continue;
    const Vector3 mean = find_mean_velocity(relaxation, at);
    if (is_real_time) set_damped_speeds(relaxation.lattice(at), mean, relaxation.view[at]);
    relaxation.drifted[at] = drift(relaxation.lattice(at), relaxation.view[at], h, relaxation.cap[at], mean);
    if (!(relaxation.drifted[at].speed_square > 1.0f)) continue;
    capped = static_cast<int>(at);
    if (!relaxation.lattice(at).has_fixed_nodes()) {
      restore_momentum(relaxation.lattice(at), relaxation.view[at], mean);
    }
  }
  return capped;
}

// Fraction of speed_cap_cells by which a node may move in a substep at its speed at the start of a tick, or
// at the speed at which the body hits another one. It may become faster within the tick: a contact moves
// light nodes beside it by several times the speed that it takes from its point.
constexpr double started_cap_fraction = 0.25;

// Returns the highest speed of a node of the body itself, relative to the mean velocity of the body, m/s.
double find_fastest_m_per_s(const Relaxation& relaxation, std::size_t at) {
  const LatticeView& view = relaxation.view[at];
  const LatticeMesh& mesh = relaxation.lattice(at).mesh();
  const Vector3 mean = find_mean_velocity(relaxation, at);
  double square = 0.0;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const bool is_outside = !mesh.node_locations.empty() &&
                            mesh.node_locations[static_cast<std::size_t>(n)] == NodeLocation::outside_body;
    if (view.free_node[n] == 0.0f || is_outside) continue;
    square = std::max(square, (Vector3(view.vx[n], view.vy[n], view.vz[n]) - mean).squaredNorm());
  }
  return std::sqrt(square);
}

// Returns the number of substeps that the speeds of nodes and of impacts require in real time, at most as
// many as substep_ceiling allows.
int count_substeps_for_speed(const Relaxation& relaxation, const RelaxSettings& settings,
                             const BodyContacts* between) {
  if (!settings.is_real_time) return 1;
  std::array<double, lattice_capacity> impacts_m_per_s{};
  if (between) {
    impacts_m_per_s =
        between->find_impacts_m_per_s({relaxation.view.data(), relaxation.count()}, settings.time_s);
  }
  double most = 1.0;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    const double fastest_m_per_s = std::max(find_fastest_m_per_s(relaxation, at), impacts_m_per_s[at]);
    const double reach_m =
        started_cap_fraction * speed_cap_cells * static_cast<double>(relaxation.lattice(at).cell_size_m());
    most = std::max(most, std::ceil(settings.time_s * fastest_m_per_s / reach_m));
  }
  return static_cast<int>(std::min(most, static_cast<double>(substep_ceiling * settings.substeps)));
}

Substeps choose_substeps(const Relaxation& relaxation, const RelaxSettings& settings) {
  Substeps most{1, false};
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (relaxation.dynamics(at)) most.count = std::max(most.count, settings.substeps);
    if (!relaxation.has_springs(at)) continue;
    const Substeps required = choose_substeps(relaxation.lattice(at), settings);
    if (required.slowed) most.slowed_lattice = static_cast<int>(at);
    most.count = std::max(most.count, required.count);
    most.slowed = most.slowed || required.slowed;
  }
  return most;
}

void stabilise_strained_nodes(Relaxation& relaxation, float h) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    SpringLattice& lattice = relaxation.lattice(at);
    relaxation.view[at].inverse_mass =
        lattice.stabilise_strained_nodes(h, static_cast<float>(stability_fraction));
    // The velocities have changed, and the linearisation depends on them.
    relaxation.springs[at] = linearise(lattice, relaxation.view[at], Linearised::tangents);
  }
}

// Moves overlapping bodies apart. Call after everything else has moved them in the substep.
void separate_bodies(const Relaxation& relaxation, BodyContacts& between, float h) {
  between.separate({relaxation.view.data(), relaxation.count()}, static_cast<double>(h),
                   find_push_caps(relaxation));
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (relaxation.has_springs(at)) join_seam_positions(relaxation.view[at]);
  }
}

// Chooses what the linearisation at the start of a tick stores. The spring tangents are needed by later
// substeps, by critical damping and by LatticeKernels::damp_further(); otherwise the spring forces suffice.
Linearised choose_linearisation(const SpringLattice& lattice, const RelaxSettings& settings, int substeps) {
  return substeps == 1 && !settings.is_critically_damped && !lattice.is_damped_further()
             ? Linearised::forces
             : Linearised::tangents;
}

// Linearises all springs at the start of a tick and returns the substeps that the tick needs. If `follows` is
// true, also tracks the fastest frequencies.
Substeps begin_springs(Relaxation& relaxation, const RelaxSettings& settings, const BodyContacts* between,
                       bool follows) {
  for (std::size_t at = 0; at < relaxation.count() && settings.is_real_time; ++at) {
    if (!relaxation.has_springs(at)) continue;
    relaxation.lattice(at).continue_displacements();
    relaxation.lattice(at).find_flat_corners();
    set_damped_speeds(relaxation.lattice(at), find_mean_velocity(relaxation, at), relaxation.view[at]);
  }
  const int for_speed = count_substeps_for_speed(relaxation, settings, between);
  const int expected =
      settings.step_division * std::max(choose_substeps(relaxation, settings).count, for_speed);
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    SpringLattice& lattice = relaxation.lattice(at);
    const Linearised stored = choose_linearisation(lattice, settings, expected);
    const LatticeView& view = relaxation.view[at];
    relaxation.springs[at] =
        follows ? linearise_and_follow(lattice, view, stored) : linearise(lattice, view, stored);
  }
  Substeps substeps = choose_substeps(relaxation, settings);
  substeps.count = settings.step_division * std::max(substeps.count, for_speed);
  return substeps;
}

// Lets the nodes outside all bodies follow. In real time, they would otherwise be thrown by a sudden stop.
void continue_velocities(Relaxation& relaxation) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    relaxation.lattice(at).continue_velocities(
        make_speed_cap(relaxation.cap[at], find_mean_velocity(relaxation, at)));
  }
}

void flow(Relaxation& relaxation) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const SpringLattice& lattice = relaxation.lattice(at);
    const Material& material = lattice.material();
    if (!lattice.flows() || !relaxation.has_springs(at)) continue;
    const double time_s = 2.0 * relaxation.time_s;
    const double step = std::min(largest_flow_step, material.flow_rate_per_s * time_s);
    lattice.kernels().flow(relaxation.view[at],
                           {static_cast<float>(material.yield_strain), static_cast<float>(material.hardening),
                            static_cast<float>(step), static_cast<float>(time_s)});
  }
}

// Applies creep to the springs of one direction; `turn` selects the direction. The time step is the time
// until the next call for the same direction.
void creep(Relaxation& relaxation, std::uint64_t turn, double tick_s) {
  const int direction = static_cast<int>(turn % lattice_direction_count);
  const double time_s = tick_s * static_cast<double>(creep_pause * lattice_direction_count);
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const SpringLattice& lattice = relaxation.lattice(at);
    const Material& material = lattice.material();
    if (!lattice.creeps() || !relaxation.has_springs(at)) continue;
    const double step = 1.0 / (1.0 + material.relaxation_time_s / time_s);
    lattice.kernels().creep(relaxation.view[at], direction,
                            {static_cast<float>(material.relaxing_fraction), static_cast<float>(step),
                             static_cast<float>(time_s)});
  }
}

// Sets the drag of each lattice. The springs must be linearised.
void choose_drag(Relaxation& relaxation, const RelaxSettings& settings) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    double& drag = relaxation.drag_per_s[at];
    drag = settings.drag_per_s;
    if (!settings.is_critically_damped || relaxation.is_rigid(at)) continue;
    const double quotient = relaxation.has_springs(at)
                                ? rayleigh_quotient(relaxation.lattice(at), relaxation.view[at])
                                : relaxation.lattices[at].implicit_solver->rayleigh_quotient();
    drag = std::max(drag, critical_damping_per_s(quotient));
  }
}

std::span<GroundContact> ground_contacts(GroundContacts* ground, std::size_t at) {
  return ground ? ground->of_body(static_cast<int>(at)) : std::span<GroundContact>();
}

void begin_implicit_steps(const Relaxation& relaxation, const BodyContacts* between, GroundContacts* ground) {
  const double time_s = relaxation.time_s;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    if (!relaxed.implicit_solver) continue;
    const ImplicitStep step{time_s, relaxation.drag_per_s[at], relaxed.gravity_m_per_s2};
    for (const SupportedNodes& support : relaxed.supports) {
      if (support.moves)
        relaxed.implicit_solver->move_fixed(support.nodes, (support.end_m - support.start_m) / time_s);
    }
    if (between) {
      between->visit_known_impulses(static_cast<int>(at), [&](int node, const Vector3& impulse) {
        relaxed.implicit_solver->add_known_impulse(*relaxed.lattice, node, impulse);
      });
    }
    relaxed.implicit_solver->begin_step(step, *relaxed.lattice, ground_contacts(ground, at));
    for (SupportedNodes& support : relaxed.supports) {
      support.impulse_ns -= time_s * relaxed.implicit_solver->force_on_fixed(*relaxed.lattice, support.nodes,
                                                                             relaxed.gravity_m_per_s2);
    }
  }
}

void end_implicit_steps(const Relaxation& relaxation, BodyContacts* between, GroundContacts* ground) {
  respond_to_pairs(relaxation, between);
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    if (!relaxed.implicit_solver) continue;
    const double cap = 0.5 * static_cast<double>(relaxation.push_cap[at]);
    relaxed.implicit_solver->end_step(*relaxed.lattice, {ground, ground_contacts(ground, at), cap});
  }
}

// Returns the cap of a rigid body, which limits only how fast contacts correct an overlap.
float rigid_speed_cap(const Relaxation& relaxation, std::size_t at, float h) {
  if (relaxation.dynamics(at) == nullptr) return std::numeric_limits<float>::infinity();
  return static_cast<float>(speed_cap_cells) * relaxation.lattice(at).cell_size_m() / h;
}

}  // namespace

RelaxReport relax(std::span<const RelaxedLattice> lattices, const RelaxSettings& settings,
                  std::span<const TouchingTool> tools, BodyContacts* between, GroundContacts* ground) {
  SPOONBILL_ASSERT(!lattices.empty() && lattices.size() <= static_cast<std::size_t>(lattice_capacity));
  SPOONBILL_ASSERT(settings.substeps >= 1 && settings.step_division >= 1 && settings.time_s > 0.0);
  SPOONBILL_ASSERT(settings.drag_per_s >= 0.0);
  Relaxation relaxation{lattices,       {}, {}, {}, {}, {}, {}, settings.time_s, settings.is_real_time, {},
                        Vector3::Zero()};
  const bool flows = settings.tick % 2 == 1;
  for (std::size_t at = 0; at < lattices.size(); ++at) relaxation.view[at] = lattices[at].lattice->view();
  const Substeps substeps = begin_springs(relaxation, settings, between, !flows);
  choose_drag(relaxation, settings);
  RelaxReport report;
  report.substeps = substeps.count;
  report.nodes_slowed = substeps.slowed;
  report.at_fault = substeps.slowed_lattice;
  const float h = static_cast<float>(settings.time_s / substeps.count);
  for (std::size_t at = 0; at < lattices.size(); ++at) {
    if (relaxation.is_rigid(at)) {
      relaxation.cap[at] = relaxation.push_cap[at] = rigid_speed_cap(relaxation, at, h);
      continue;
    }
    relaxation.push_cap[at] = speed_cap(relaxation.lattice(at), h);
    relaxation.cap[at] =
        settings.is_real_time ? real_time_speed_cap(relaxation.lattice(at), h) : relaxation.push_cap[at];
  }
  report.speed_capped = begin_supports(relaxation);
  begin_rigid_motions(relaxation);
  begin_implicit_steps(relaxation, between, ground);
  for (const TouchingTool& tool : tools) tool.contacts->begin(tool.motion, settings.time_s);
  const TouchingTool* const soft = find_soft_tool(tools);
  if (soft) {
    relaxation.view[static_cast<std::size_t>(soft->motion.carried.body)].frame = &relaxation.frame;
    relaxation.frame_m = soft->state->position_m;
  }
  if (substeps.slowed) stabilise_strained_nodes(relaxation, h);
  for (int s = 0; s < substeps.count; ++s) {
    const Substep substep{s, substeps.count, h, settings.parts};
    kick(relaxation, substep);
    solve_contacts(relaxation, substep, tools, between, ground);
    if (settings.is_real_time) continue_velocities(relaxation);
    if (const int capped = drift(relaxation, h, settings.is_real_time); capped >= 0) {
      report.speed_capped = true;
      report.at_fault = capped;
    }
    if (soft) move_soft_tool(relaxation, *soft);
    move_supported_nodes(relaxation, static_cast<double>(s + 1) / substeps.count);
    move_rigid_bodies(relaxation, substep);
    if (between && between->count() > 0) separate_bodies(relaxation, *between, h);
  }
  end_implicit_steps(relaxation, between, ground);
  if (flows) flow(relaxation);
  const bool is_tick_over = settings.part + 1 == settings.parts;
  if (is_tick_over && settings.tick % creep_pause == 0) {
    creep(relaxation, settings.tick / creep_pause, settings.time_s * settings.parts);
  }
  return report;
}

double critical_damping_per_s(double quotient) {
  return std::isfinite(quotient) ? 2.0 * critical_damping_fraction * std::sqrt(std::max(0.0, quotient)) : 0.0;
}

double rayleigh_quotient(const SpringLattice& lattice, const LatticeView& view) {
  LatticeView along = view;
  along.spring_weight = 1.0f;
  along.power_x = view.moved_x;
  along.power_y = view.moved_y;
  along.power_z = view.moved_z;
  for (int n = 0; n < view.padded_count; ++n) {
    along.power_x[n] = view.vx[n] * view.free_node[n];
    along.power_y[n] = view.vy[n] * view.free_node[n];
    along.power_z[n] = view.vz[n] * view.free_node[n];
  }
  // For the nodes' velocities v, the stiffness K and the inertia M, the power step sets
  // w = M^-1 K v / |M^-1 K v| and returns |M^-1 K v| / |v|.
  const double growth = static_cast<double>(lattice.kernels().power_step(along, lattice.free_mass()));
  double with_image = 0.0, motion_square = 0.0, image_square = 0.0;
  for (int n = 0; n < view.padded_count; ++n) {
    const double mass = static_cast<double>(lattice.free_mass()[n]);
    const Vector3 v(view.vx[n], view.vy[n], view.vz[n]);
    const Vector3 w(along.power_x[n], along.power_y[n], along.power_z[n]);
    with_image += mass * v.dot(w);
    motion_square += mass * v.squaredNorm();
    image_square += mass * w.squaredNorm();
  }
  const double sizes = std::sqrt(motion_square * image_square);
  return sizes > 0.0 ? growth * with_image / sizes : 0.0;
}

}  // namespace spoonbill
