#include "engine/material/lattice_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/settling.h"
#include "engine/material/springs/node_motion.h"
#include "engine/material/supports/support_motion.h"

namespace spoonbill {
namespace {

// Ticks from one creep to the next. What creeps in a tick would be lost in the rounding of a rest length.
constexpr std::uint64_t creep_pause = 8;

struct Substeps {
  int count;
  double h;
  bool slowed;
};

Substeps choose_substeps(const SpringLattice& lattice, double step_s) {
  const double omega = lattice.fastest_frequency();
  const double limit = stability_share * stable_step_s(omega, lattice.damping_ratio());
  const double wanted = std::ceil(step_s / limit);
  if (!(wanted <= substep_ceiling)) return {substep_ceiling, step_s / substep_ceiling, true};
  const int count = std::max(1, static_cast<int>(wanted));
  return {count, step_s / count, false};
}

void apply_node_forces(const SpringLattice& lattice, const LatticeView& view) {
  if (!lattice.has_applied_force()) return;
  for (int i = 0; i < view.padded_count; ++i) {
    view.fx[i] += lattice.applied_force(0)[i];
    view.fy[i] += lattice.applied_force(1)[i];
    view.fz[i] += lattice.applied_force(2)[i];
  }
}

void linearise(const SpringLattice& lattice, const LatticeView& view, Linearised kept) {
  lattice.kernels().look_ahead(view, lattice.damping_time_s());
  lattice.kernels().linearise_springs(view, kept);
}

// One step of the power iteration every other tick follows the fastest frequency as the lattice deforms.
void linearise_and_follow(SpringLattice& lattice, const LatticeView& view, Linearised kept) {
  lattice.kernels().look_ahead(view, lattice.damping_time_s());
  const float square = lattice.kernels().linearise_with_power_step(view, kept, lattice.free_mass());
  if (square > 0.0f && std::isfinite(square)) lattice.set_fastest_frequency(std::sqrt(square));
}

// See speed_cap_cells.
float speed_cap(const SpringLattice& lattice, float h) {
  const auto longest = static_cast<float>(2.0 / lattice.fastest_frequency());
  return static_cast<float>(speed_cap_cells) * lattice.cell_size_m() / std::max(h, longest);
}

// Caps speeds relative to that of the frame and moves the nodes.
Drifted drift(const SpringLattice& lattice, const LatticeView& view, float h, float cap,
              const Vector3& frame) {
  Drift drift;
  drift.h_s = h;
  drift.cap_m_per_s = cap;
  drift.tau_s = lattice.damping_time_s();
  drift.mean_x = static_cast<float>(frame.x());
  drift.mean_y = static_cast<float>(frame.y());
  drift.mean_z = static_cast<float>(frame.z());
  return lattice.kernels().drift(view, drift);
}

// `moved_square` is of the node that moved furthest since the springs were linearised.
void take_forces(const SpringLattice& lattice, const LatticeView& view, float moved_square) {
  const LatticeKernels& kernels = lattice.kernels();
  const float limit = static_cast<float>(linear_cells) * lattice.cell_size_m();
  const bool linear = moved_square <= limit * limit;
  if (!linear) kernels.linearise_springs(view, Linearised::tangents);
  kernels.start_forces(view);
  if (linear && moved_square > 0.0f) kernels.spring_forces(view);
  kernels.volume_forces(view);
  if (lattice.is_damped_further()) kernels.damp_further(view);
  apply_node_forces(lattice, view);
}

// The lattices of one tick, as far as they differ.
struct Relaxation {
  std::span<const RelaxedLattice> lattices;
  std::array<LatticeView, lattice_capacity> view;
  std::array<float, lattice_capacity> cap{};  // m/s
  std::array<Drifted, lattice_capacity> drifted{};
  std::array<double, lattice_capacity> damping_per_s{};
  double time_s = 0.0;  // of the material, in the tick

  std::size_t count() const { return lattices.size(); }
  bool has_springs(std::size_t at) const { return lattices[at].core == nullptr; }
  SpringLattice& lattice(std::size_t at) const { return *lattices[at].lattice; }
};

void kick(Relaxation& relaxation, float h) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    const SpringLattice& lattice = relaxation.lattice(at);
    const LatticeView& view = relaxation.view[at];
    const Vector3& g = relaxation.lattices[at].gravity_m_per_s2;
    const float decay = 1.0f / (1.0f + h * static_cast<float>(relaxation.damping_per_s[at]));
    take_forces(lattice, view, relaxation.drifted[at].moved_square);
    bear(relaxation.lattices[at].supports, lattice, view, g, static_cast<double>(h));
    lattice.kernels().kick(view, h, decay, static_cast<float>(g.x()), static_cast<float>(g.y()),
                           static_cast<float>(g.z()));
    hand_to_supports(relaxation.lattices[at].supports, view, relaxation.time_s);
  }
}

void solve_contacts(const Relaxation& relaxation, float h, double fraction,
                    std::span<const TouchingTool> tools, BodyContacts* between, GroundContacts* ground) {
  const std::span<const LatticeView> views(relaxation.view.data(), relaxation.count());
  std::array<float, lattice_capacity> push_caps{};
  for (std::size_t at = 0; at < relaxation.count(); ++at) push_caps[at] = 0.5f * relaxation.cap[at];
  for (const TouchingTool& tool : tools) tool.contacts->solve(views, *tool.state, h, fraction, push_caps);
  if (between) between->solve(views, h, push_caps);
  if (!ground) return;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    ground->solve(static_cast<int>(at), relaxation.view[at], static_cast<double>(h),
                  static_cast<double>(push_caps[at]));
  }
}

// What carried nodes pull at the tool with, and their velocity, which the kick has taken.
void hand_over(const Relaxation& relaxation, std::span<const TouchingTool> tools) {
  for (const TouchingTool& tool : tools) {
    const CarriedNodes& carried = tool.motion.carried;
    if (carried.body < 0) continue;
    const LatticeView& view = relaxation.view[static_cast<std::size_t>(carried.body)];
    Vector3 force = Vector3::Zero();
    for (const int n : carried.nodes) {
      force += Vector3(view.fx[n], view.fy[n], view.fz[n]);
      set_velocity(view, n, tool.state->velocity_m_per_s);
    }
    tool.contacts->pull_tool(force);
  }
}

// Places carried nodes where the tool now is.
void carry(Relaxation& relaxation, std::span<const TouchingTool> tools) {
  for (const TouchingTool& tool : tools) {
    const CarriedNodes& carried = tool.motion.carried;
    if (carried.body < 0) continue;
    const auto at = static_cast<std::size_t>(carried.body);
    const SpringLattice& lattice = relaxation.lattice(at);
    const LatticeView& view = relaxation.view[at];
    for (const int n : carried.nodes) {
      const Vector3& rest = lattice.mesh().nodes[static_cast<std::size_t>(n)];
      const Vector3 moved = tool.state->position_m + tool.motion.orientation * rest - rest;
      set_velocity(view, n, tool.state->velocity_m_per_s);
      const float square = place_node(view, n, moved, lattice.damping_time_s());
      relaxation.drifted[at].moved_square = std::max(relaxation.drifted[at].moved_square, square);
    }
  }
}

// Places supported nodes at this share of their way.
void place_supported(Relaxation& relaxation, double share) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const float square = place_supported(relaxation.lattices[at].supports, relaxation.view[at], share,
                                         relaxation.lattice(at).damping_time_s());
    relaxation.drifted[at].moved_square = std::max(relaxation.drifted[at].moved_square, square);
  }
}

// Returns whether a support had to be held back.
bool begin_supports(Relaxation& relaxation) {
  bool limited = false;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    if (relaxed.supports.empty()) continue;
    const double reach_m = static_cast<double>(relaxation.cap[at]) * relaxation.time_s;
    limited |= limit_ways(relaxed.supports, *relaxed.lattice, reach_m);
    hand_to_supports(relaxed.supports, relaxation.view[at], relaxation.time_s);
  }
  return limited;
}

// What the speeds of a lattice's nodes are relative to.
Vector3 frame_velocity(const Relaxation& relaxation, std::size_t at, std::span<const TouchingTool> tools) {
  for (const TouchingTool& tool : tools) {
    if (tool.motion.carried.body == static_cast<int>(at)) return tool.state->velocity_m_per_s;
  }
  const SpringLattice& lattice = relaxation.lattice(at);
  if (lattice.has_held_nodes()) {
    return riding_velocity(relaxation.lattices[at].supports, lattice, relaxation.time_s);
  }
  float sum[4];
  lattice.kernels().momentum(relaxation.view[at], lattice.free_mass(), sum);
  const float inverse = sum[3] > 0.0f ? 1.0f / sum[3] : 0.0f;
  return Vector3(sum[0] * inverse, sum[1] * inverse, sum[2] * inverse);
}

// Returns whether a node met the speed cap.
bool drift(Relaxation& relaxation, float h, std::span<const TouchingTool> tools) {
  bool capped = false;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    relaxation.drifted[at] = drift(relaxation.lattice(at), relaxation.view[at], h, relaxation.cap[at],
                                   frame_velocity(relaxation, at, tools));
    capped |= relaxation.drifted[at].speed_square > 1.0f;
  }
  return capped;
}

Substeps choose_substeps(const Relaxation& relaxation, double step_s) {
  Substeps most{1, step_s, false};
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    const Substeps wanted = choose_substeps(relaxation.lattice(at), step_s);
    most.slowed |= wanted.slowed;
    if (wanted.count > most.count) most = {wanted.count, wanted.h, most.slowed};
  }
  return most;
}

void steady_strained_nodes(Relaxation& relaxation, float h) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    SpringLattice& lattice = relaxation.lattice(at);
    relaxation.view[at].inverse_mass = lattice.steady_strained_nodes(h, static_cast<float>(stability_share));
    linearise(lattice, relaxation.view[at], Linearised::tangents);  // velocities changed
  }
}

// What the tick asks of a lattice's linearisation, as far as can be told before the frequency is followed.
Linearised kept_of(const SpringLattice& lattice, const RelaxSettings& settings, int substeps) {
  const bool one = settings.iterations * substeps == 1;
  return one && !settings.settles && !lattice.is_damped_further() ? Linearised::forces : Linearised::tangents;
}

// Linearises all springs at the start of a tick, and chooses its substeps.
Substeps begin_springs(Relaxation& relaxation, const RelaxSettings& settings, bool follows) {
  const int foreseen = choose_substeps(relaxation, settings.step_s).count;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    if (!relaxation.has_springs(at)) continue;
    SpringLattice& lattice = relaxation.lattice(at);
    const Linearised kept = kept_of(lattice, settings, foreseen);
    if (follows) {
      linearise_and_follow(lattice, relaxation.view[at], kept);
    } else {
      linearise(lattice, relaxation.view[at], kept);
    }
  }
  const Substeps substeps = choose_substeps(relaxation, settings.step_s);
  for (std::size_t at = 0; at < relaxation.count() && substeps.count > foreseen; ++at) {
    if (!relaxation.has_springs(at)) continue;
    linearise(relaxation.lattice(at), relaxation.view[at], Linearised::tangents);
  }
  return substeps;
}

void flow(Relaxation& relaxation, double material_time_s) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const SpringLattice& lattice = relaxation.lattice(at);
    const Material& material = lattice.material();
    if (!lattice.flows() || !relaxation.has_springs(at)) continue;
    const double time_s = 2.0 * material_time_s;
    const double step = std::min(largest_flow_step, 2.0 * material.flow_rate_per_s * material_time_s);
    lattice.kernels().flow(relaxation.view[at],
                           {static_cast<float>(material.yield_strain), static_cast<float>(material.hardening),
                            static_cast<float>(step), static_cast<float>(time_s)});
  }
}

// Springs of one direction after the other, each for the time until its next turn. By the hand's time: a
// material creeps while somebody waits, however many relaxation steps the tool takes in a tick.
void creep(Relaxation& relaxation, std::uint64_t turn, double tick_time_s) {
  const int direction = static_cast<int>(turn % lattice_direction_count);
  const double time_s = tick_time_s * static_cast<double>(creep_pause * lattice_direction_count);
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const SpringLattice& lattice = relaxation.lattice(at);
    const Material& material = lattice.material();
    if (!lattice.creeps() || !relaxation.has_springs(at)) continue;
    const double step = 1.0 / (1.0 + material.relaxation_time_s / time_s);
    lattice.kernels().creep(
        relaxation.view[at], direction,
        {static_cast<float>(material.relaxing_fraction), static_cast<float>(step), static_cast<float>(time_s)});
  }
}

// With the springs linearised.
void choose_damping(Relaxation& relaxation, const RelaxSettings& settings) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    double& damping = relaxation.damping_per_s[at];
    damping = settings.damping_per_s;
    if (!settings.settles) continue;
    const double quotient = relaxation.has_springs(at)
                                ? rayleigh_quotient(relaxation.lattice(at), relaxation.view[at])
                                : relaxation.lattices[at].core->rayleigh_quotient();
    damping = std::max(damping, settling_damping_per_s(quotient));
  }
}

std::span<GroundContact> on_ground(GroundContacts* ground, std::size_t at) {
  return ground ? ground->of_body(static_cast<int>(at)) : std::span<GroundContact>();
}

void begin_core_steps(const Relaxation& relaxation, GroundContacts* ground) {
  const double time_s = relaxation.time_s;
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    if (!relaxed.core) continue;
    const ImplicitStep step{time_s, relaxation.damping_per_s[at], relaxed.gravity_m_per_s2};
    for (const SupportedNodes& support : relaxed.supports) {
      if (support.moves) relaxed.core->move_held(support.nodes, (support.end_m - support.start_m) / time_s);
    }
    relaxed.core->begin_step(step, *relaxed.lattice, on_ground(ground, at));
    for (SupportedNodes& support : relaxed.supports) {
      support.impulse_ns -=
          time_s * relaxed.core->force_on_held(*relaxed.lattice, support.nodes, relaxed.gravity_m_per_s2);
    }
  }
}

void end_core_steps(const Relaxation& relaxation, GroundContacts* ground) {
  for (std::size_t at = 0; at < relaxation.count(); ++at) {
    const RelaxedLattice& relaxed = relaxation.lattices[at];
    if (!relaxed.core) continue;
    const double cap = 0.5 * static_cast<double>(relaxation.cap[at]);
    relaxed.core->end_step(*relaxed.lattice, {ground, on_ground(ground, at), cap});
  }
}

}  // namespace

double stable_step_s(double angular_frequency, double damping_ratio) {
  SPOONBILL_ASSERT_DEBUG(angular_frequency > 0.0 && damping_ratio >= 0.0);
  return 2.0 / angular_frequency * (std::sqrt(1.0 + damping_ratio * damping_ratio) - damping_ratio);
}

double felt_modulus_limit_pa(double unit_frequency, double damping_ratio) {
  SPOONBILL_ASSERT(unit_frequency > 0.0 && damping_ratio >= 0.0);
  const double root = felt_stability_share * stable_step_s(unit_frequency, damping_ratio) / relaxation_step_s;
  return root * root;
}

RelaxReport relax(std::span<const RelaxedLattice> lattices, const RelaxSettings& settings,
                  std::span<const TouchingTool> tools, BodyContacts* between, GroundContacts* ground) {
  SPOONBILL_ASSERT(!lattices.empty() && lattices.size() <= static_cast<std::size_t>(lattice_capacity));
  SPOONBILL_ASSERT(settings.iterations >= 1 && settings.step_s > 0.0);
  SPOONBILL_ASSERT(settings.damping_per_s >= 0.0);
  Relaxation relaxation{lattices, {}, {}, {}, {}, 0.0};
  const bool flows = settings.tick % 2 == 1;
  for (std::size_t at = 0; at < lattices.size(); ++at) relaxation.view[at] = lattices[at].lattice->view();
  const Substeps substeps = begin_springs(relaxation, settings, !flows);
  choose_damping(relaxation, settings);
  RelaxReport report;
  report.substeps = substeps.count;
  report.nodes_slowed = substeps.slowed;
  report.material_time_s = settings.iterations * substeps.count * substeps.h;
  relaxation.time_s = report.material_time_s;
  const float h = static_cast<float>(substeps.h);
  for (std::size_t at = 0; at < lattices.size(); ++at) {
    relaxation.cap[at] = speed_cap(relaxation.lattice(at), h);
  }
  report.speed_capped = begin_supports(relaxation);
  begin_core_steps(relaxation, ground);
  for (const TouchingTool& tool : tools) tool.contacts->begin(tool.motion, report.material_time_s);
  if (substeps.slowed) steady_strained_nodes(relaxation, h);
  const int total = settings.iterations * substeps.count;
  for (int s = 0; s < total; ++s) {
    kick(relaxation, h);
    hand_over(relaxation, tools);
    solve_contacts(relaxation, h, static_cast<double>(s) / total, tools, between, ground);
    report.speed_capped |= drift(relaxation, h, tools);
    carry(relaxation, tools);
    place_supported(relaxation, static_cast<double>(s + 1) / total);
  }
  end_core_steps(relaxation, ground);
  if (flows) flow(relaxation, report.material_time_s);
  if (settings.tick % creep_pause == 0) {
    creep(relaxation, settings.tick / creep_pause, settings.step_s);
  }
  return report;
}

}  // namespace spoonbill
