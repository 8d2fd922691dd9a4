// Steps lattices through one tick together: relaxation steps of fixed material time, cut into symplectic
// Euler substeps by the stability limit, with the constraints of tools and between bodies inside. Allocates
// nothing.
#pragma once

#include <cstdint>
#include <span>

#include "engine/material/contact/body_contacts.h"
#include "engine/material/contact/contact_constraints.h"
#include "engine/material/contact/ground_contacts.h"
#include "engine/material/implicit/implicit_core.h"
#include "engine/material/springs/spring_lattice.h"
#include "engine/material/supports/supported_nodes.h"

namespace spoonbill {

// The material time of a relaxation step: a haptic tick's.
inline constexpr double relaxation_step_s = 1e-3;

// Substeps a relaxation step may take. Where strain would ask for more, the strained nodes count as heavier,
// just as much as keeps them stable: the stated fallback. They answer more slowly, which a damped,
// quasi-static body hardly shows; the rest is as before.
inline constexpr int substep_ceiling = 4;

// The share of the measured stability limit that a substep takes. The running estimate of the fastest
// frequency lags a sudden contact by some tens of ticks.
inline constexpr double stability_share = 0.85;

// The share of it that a felt stiffness may take with one substep. Strain and flow raise the fastest
// frequency by 1.2 to 1.6 times; where they do, a relaxation step takes a second substep.
inline constexpr double felt_stability_share = 0.75;

// No node moves further than this share of a cell in a substep, relative to the body's mean velocity, or to
// what holds the body where a node is held; nor in 2 / w, the longest step that the lattice alone could take.
// Waves pass a cell in about that time, so that nodes stay below a ninth of their speed and a blow strains
// even a soft, undamped body by no more than its springs can bring back. Without the latter two, a
// sphere of 16 mm that gripped a held gel of 4 Pa at up to 5 m/s drew it out to 28 m.
inline constexpr double speed_cap_cells = 0.1;

// Springs are linearised once a tick, and again where a node has moved further than this share of a cell
// since. What first order misses of a spring's strain is then below half its square; a tick of a sculpting
// hand moves nodes by a hundredth of a cell.
inline constexpr double linear_cells = 0.1;

// The largest stable symplectic Euler step for the angular frequency and damping ratio: h < (2 / w)
// (sqrt(1 + z^2) - z), from |trace| <= 1 + determinant of the update matrix of x'' + 2 z w x' + w^2 x = 0.
double stable_step_s(double angular_frequency, double damping_ratio);

// The largest Young's modulus at which one relaxation step takes one substep, for a lattice whose
// fastest frequency is `unit_frequency` at 1 Pa: frequencies grow with the root of the modulus.
double felt_modulus_limit_pa(double unit_frequency, double damping_ratio);

// Following the fastest frequency and plastic flow each cost about as much as a substep. They take turns: the
// first in even ticks, the second in odd ones, for the material time of both.
struct RelaxSettings {
  std::uint64_t tick = 0;             // its number
  int iterations = 1;                 // relaxation steps
  double step_s = relaxation_step_s;  // material time of each
  double damping_per_s = 0.0;         // mass-proportional; where they settle, the least
  bool settles = false;               // each body as settling.h damps it
};

struct RelaxedLattice {
  SpringLattice* lattice;
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  ImplicitCore* core = nullptr;  // where one moves the lattice, its springs rest
  std::span<SupportedNodes> supports = {};
};

struct RelaxReport {
  int substeps = 0;              // of each relaxation step
  double material_time_s = 0.0;  // that passed
  bool nodes_slowed = false;     // the ceiling was met
  bool speed_capped = false;
};

// A tool that acts on the lattice: how the hand moves it, where it is, and its contacts of this tick.
struct TouchingTool {
  ToolMotion motion;
  ToolState* state;
  ContactConstraints* contacts;
};

// Advances at most lattice_capacity lattices, by as many substeps as the one that needs most; those with a
// core by one implicit step, around the contacts. The tools act in their order, then the bodies on each
// other, then the ground. Denormals must be flushed by the caller for the speed's sake (see
// DenormalsFlushed).
RelaxReport relax(std::span<const RelaxedLattice> lattices, const RelaxSettings& settings,
                  std::span<const TouchingTool> tools, BodyContacts* between = nullptr,
                  GroundContacts* ground = nullptr);

}  // namespace spoonbill
