// A trial: bodies in real time under gravity. Says which commands a simulation needs from tick to tick, and
// when the trial ends.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/spill.h"

namespace spoonbill {

inline constexpr double standard_gravity_m_per_s2 = 9.80665;

// Bodies have settled when no node has moved faster than settled_speed_m_per_s for settled_time_s.
inline constexpr double settled_speed_m_per_s = 1e-4;
inline constexpr double settled_time_s = 0.2;

struct TrialSettings {
  double seconds = 3.0;              // time after the last turn or motion, or after the settling
  double longest_settling_s = 10.0;  // time after which a trial goes on although the bodies still move
};
inline constexpr Range<double> trial_seconds_range{0.0, 600.0};

// Returns the scene as a trial simulates it: with the true inertia of all bodies, without the drag that helps
// sculpting, with bodies free to move, and with a point as the tool. A soft solid that fills at least a
// quarter of the box about it gets equal cells (LatticeCells::box), unless it is fixed somewhere or its
// document states node counts or a feature map. A scene without gravity gets standard gravity along -y.
// `tilt_deg` replaces the angle of the plan. Fails if a tilt is given but nothing turns, if all bodies are
// fixed, and if a body is a liquid: if its yield stress, which is Young's modulus times the yield strain, is
// under 0.3 of the pressure that its own height causes.
Result<Scene> make_trial_scene(Scene scene, std::optional<double> tilt_deg);

// Fails if a support or a plane holds the body that the trial would lower.
Status check_trial_start(const Simulation& simulation);

// The parts of a trial, in their order. Parts for which the plan names no body, or for which no body states a
// motion, are left out.
enum class TrialPhase { lowering, settling, turning, moving, watching, done };
inline constexpr const char* trial_phase_names[] = {"lowering", "settling", "turning",
                                                    "moving",   "watching", "done"};

// Course of a trial. Has one owner, which runs the ticks:
//
//   Trial trial(simulation.scene(), settings);
//   while (trial.phase() != TrialPhase::done) {
//     while (const auto command = trial.next_command()) simulation.apply(*command);
//     const Reaction reaction = simulation.advance(trial_input());
//     if (const Status held = trial.follow(simulation, reaction.flags); !held) return held;
//   }
class Trial {
 public:
  // `scene` must be made by make_trial_scene(), and its bodies in the order of the simulation.
  Trial(const Scene& scene, const TrialSettings& settings);

  // Returns the next command to apply before the next tick, if there is one left.
  std::optional<Command> next_command();
  // Call after each tick. `flags` are the tick's flags. Fails if the simulation could not hold a body, which
  // the error names if it is known, and if no body bears the lowered body within half a minute.
  Status follow(const Simulation& simulation, std::uint32_t flags);

  TrialPhase phase() const { return phase_; }
  // Returns whether the bodies have settled by now.
  bool is_settled() const { return still_s_ >= settled_time_s; }
  // Highest speed in the last tick of a node of a body that is not fixed, m/s.
  double largest_speed_m_per_s() const { return largest_speed_m_per_s_; }
  // Largest overlap of two bodies in the trial so far (Simulation::largest_overlap_m()).
  double largest_penetration_m() const { return largest_penetration_m_; }
  double time_s() const { return static_cast<double>(ticks_) * tick_s; }
  // Angle by which the body that turns has turned in its turn, in degrees; empty if nothing turns.
  std::optional<double> turned_deg(const Simulation& simulation) const;

  // Returns what of a body is outside the rim; null if the body has not been inside a rim.
  const Spill* spill(std::size_t body) const { return spills_.find(body); }

  // Means over the last mean_force_s, or over the trial if it is shorter.
  static constexpr double mean_force_s = 0.5;
  struct MeanForces {
    Vector3 contact_n = Vector3::Zero();  // of all other bodies on the body
    Vector3 ground_n = Vector3::Zero();
    Vector3 inertial_n = Vector3::Zero();  // rate of change of the momentum of a body that is not fixed
  };
  MeanForces find_mean_forces(std::size_t body) const;

 private:
  struct Forces {
    Vector3 contact_n, ground_n;
    Vector3 momentum_ns;
  };
  void start(TrialPhase phase);
  void start_after(TrialPhase phase);  // starts the phase that follows
  void record_forces(const Simulation& simulation);

  TrialPlan plan_;
  TrialSettings settings_;
  std::optional<LowerBody> lower_;
  std::optional<TurnBody> turn_;
  std::vector<MoveBody> motions_;
  std::vector<Command> next_;
  TrialPhase phase_ = TrialPhase::done;
  std::uint64_t ticks_ = 0;
  double phase_s_ = 0.0, still_s_ = 0.0;
  double largest_speed_m_per_s_ = 0.0, largest_penetration_m_ = 0.0;
  SpillWatch spills_;
  std::vector<std::vector<Forces>> forces_;  // the last ticks of each body, in a ring
};

// Returns the box around a box about the bodies and its images along the motions of the scene's bodies, which
// carry what rests on them. If nothing falls, a picture of this box has all bodies in it throughout a trial.
Box find_box_of_motions(const Scene& scene, const Box& box);

// The input of the hand in a trial: a tool far from all bodies, which touches nothing.
ToolInput trial_input();

}  // namespace spoonbill
