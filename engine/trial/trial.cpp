#include "engine/trial/trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/strip_volumes.h"
#include "engine/bspline/surface.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/simulation/body_hold.h"
#include "engine/simulation/body_state.h"
#include "engine/simulation/rigid_body.h"

namespace spoonbill {
namespace {

constexpr double longest_lowering_s = 30.0;
constexpr std::size_t mean_ticks = static_cast<std::size_t>(Trial::mean_force_s / tick_s + 0.5);

int find_body(const Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [&](const Body& body) { return body.name == name; });
  SPOONBILL_ASSERT(found != scene.bodies.end());
  return static_cast<int>(found - scene.bodies.begin());
}

// `plan` must name the body that turns.
TurnBody find_turn(const Scene& scene, const TrialPlan& plan) {
  return {find_body(scene, plan.turned_body), plan.point_m, plan.axis, plan.angle_deg,
          plan.turn_speed_deg_per_s};
}

bool is_deformable(const Body& body) {
  return body.kind == BodyKind::deformable;
}

bool is_movable(const Body& body) {
  return body.kind != BodyKind::fixed;
}

Vector3 momentum_ns(const Simulation& simulation, int body) {
  if (!is_movable(simulation.scene().bodies[static_cast<std::size_t>(body)])) return Vector3::Zero();
  if (const RigidDynamics* const rigid = simulation.rigid_dynamics(body))
    return rigid->mass().mass_kg * rigid->velocity_m_per_s();
  return find_mass_centre(simulation.lattice(body)).momentum_ns();
}

// Returns the height of a surface along the unit vector `up`.
double find_height_m(const Surface& surface, const Vector3& up) {
  constexpr int steps = 32;  // in each direction; the height of a ball is then 0.5 % too small
  double lowest = infinity, highest = -infinity;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const double height = up.dot(position(surface, surface.u.parameter_at(static_cast<double>(i) / steps),
                                            surface.v.parameter_at(static_cast<double>(j) / steps)));
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
  }
  return highest - lowest;
}

// A body whose yield stress is under this fraction of the pressure of its own height is a liquid: it spreads
// without end, and its cells would tangle.
constexpr double least_yield_fraction = 0.3;

Status check_yields_as_solid(const Body& body, const Material& material, const Vector3& gravity_m_per_s2) {
  if (!material.plastic) return {};
  const double pressure_pa = material.density_kg_per_m3 * gravity_m_per_s2.norm() *
                             find_height_m(body.surface, gravity_m_per_s2.normalized());
  const double yield_pa = material.youngs_modulus_pa * material.yield_strain;
  if (yield_pa >= least_yield_fraction * pressure_pa) return {};
  const double least = least_yield_fraction * pressure_pa / material.youngs_modulus_pa;
  const auto digits = [](double number) { return number_text(std::round(number * 10.0) / 10.0); };
  return Error{
      ErrorCode::inconsistent,
      "body \"" + excerpt(body.name) + "\": material.yield_strain: the material yields at " +
          digits(yield_pa) + " Pa, under " + number_text(least_yield_fraction) + " of the " +
          digits(pressure_pa) +
          " Pa that the body's own height causes; it flows like a liquid, which a lattice cannot judge; "
          "use a yield strain of at least " +
          number_text(std::ceil(least * 1e4) / 1e4),
      "yield_strain"};
}

Status check_bodies_are_solid(const Scene& scene) {
  const Vector3& gravity = scene.sculpting.gravity_m_per_s2;
  for (const Body& body : scene.bodies) {
    if (!is_deformable(body)) continue;
    if (Status status = check_yields_as_solid(body, body.material, gravity); !status.ok()) return status;
    for (const MaterialRegion& region : body.regions) {
      if (!region.material) continue;
      if (Status status = check_yields_as_solid(body, *region.material, gravity); !status.ok()) return status;
    }
  }
  return {};
}

// Names the body at fault; empty if it is unknown.
std::string name_body_at_fault(const Simulation& simulation) {
  const int body = simulation.body_at_fault();
  const std::vector<Body>& bodies = simulation.scene().bodies;
  if (body < 0 || static_cast<std::size_t>(body) >= bodies.size()) return {};
  return "body \"" + bodies[static_cast<std::size_t>(body)].name + "\": ";
}

// Returns what a flag of a tick means for a trial; null if the tick was true to the material.
const char* describe_failure(std::uint32_t flags) {
  if ((flags & tick_flag_body_limited) != 0) return "its lattice was lost";
  if ((flags & tick_flag_nodes_slowed) != 0) return "it was strained too much for the substeps of a tick";
  if ((flags & tick_flag_speed_capped) != 0) return "a node moved faster than the lattice can follow";
  if ((flags & tick_flag_contact_overflow) != 0) return "the bodies have more contacts than a tick can hold";
  return nullptr;
}

bool is_soft(const Material& material) {
  return material.plastic || material.youngs_modulus_pa < stiff_youngs_modulus_pa;
}

// A body that fills less than this fraction of the box about it keeps its cells: too many equal cells would
// be void, and too few would be left for the body.
constexpr double least_filling = 0.25;

bool fills_its_box(const Surface& surface) {
  const Vector3 extent = bounding_box(surface.net).extent();
  return compute_closed_volume_m3(surface) >= least_filling * extent.prod();
}

// A block of cells that is bent into a body has flat cells along its edges, which fold first when the body
// falls. A soft solid therefore gets equal cells if they suit it, unless its document states how its nodes
// are placed.
void use_equal_cells(const std::vector<FixingPlane>& planes, Body& body) {
  if (!is_deformable(body) || body.shell_thickness_m || !body.trims.empty()) return;
  if (!planes.empty() || !body.supports.empty() || body.lattice.counts || body.lattice.feature_map) return;
  const bool soft = is_soft(body.material) &&
                    std::all_of(body.regions.begin(), body.regions.end(), [](const MaterialRegion& region) {
                      return !region.material || is_soft(*region.material);
                    });
  if (soft && check_closed(body.surface).ok() && fills_its_box(body.surface)) {
    body.lattice.cells = LatticeCells::box;
  }
}

}  // namespace

Result<Scene> make_trial_scene(Scene scene, std::optional<double> tilt_deg) {
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(), is_movable)) {
    return Error{ErrorCode::missing, "all bodies are fixed; a trial needs a deformable or rigid one", "kind"};
  }
  if (tilt_deg) {
    if (!scene.trial || scene.trial->turned_body.empty()) {
      return Error{ErrorCode::missing, "nothing is tilted; name a fixed or held body in trial.turned_body",
                   "turned_body"};
    }
    scene.trial->angle_deg = *tilt_deg;
  }
  Sculpting& sculpting = scene.sculpting;
  sculpting.drag_per_s = 0.0;
  sculpting.is_critically_damped = false;
  sculpting.free = true;
  sculpting.real_time = true;
  if (sculpting.gravity_m_per_s2.isZero(0.0)) sculpting.gravity_m_per_s2.y() = -standard_gravity_m_per_s2;
  scene.symmetry.on = false;
  scene.tool = Tool();
  scene.tool.kind = ToolKind::point;
  for (Body& body : scene.bodies) use_equal_cells(scene.planes, body);
  if (Status status = check_trial(scene); !status.ok()) return status.error();
  if (Status status = check_bodies_are_solid(scene); !status.ok()) return status.error();
  return scene;
}

Box find_box_of_motions(const Scene& scene, const Box& box) {
  constexpr int steps = 32;
  Box all = box;
  for (const Body& body : scene.bodies) {
    if (!body.motion) continue;
    RigidBody at_start;
    if (scene.trial && scene.trial->turned_body == body.name) {
      const TurnBody turn = find_turn(scene, *scene.trial);
      at_start.turn(turn);
      at_start.begin_step(turn_duration_s(turn));
    }
    const MotionPath path(*body.motion);
    for (int step = 0; step <= steps; ++step) {
      const Pose pose = path.at(path.duration_s() * step / steps, at_start.pose());
      for (int corner = 0; corner < 8; ++corner) {
        all.include(pose.position_m + pose.orientation * box.corner(corner));
      }
    }
  }
  return all;
}

ToolInput trial_input() {
  ToolInput input;
  input.pose.position_m = Vector3(0.0, 10.0, 0.0);
  input.hovering = true;
  return input;
}

Status check_trial_start(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  if (!scene.trial || scene.trial->lowered_body.empty()) return {};
  if (!simulation.lattice(find_body(scene, scene.trial->lowered_body)).has_fixed_nodes()) return {};
  return Error{ErrorCode::inconsistent,
               "trial: lowered_body: \"" + scene.trial->lowered_body +
                   "\" is fixed by a support or a plane; remove it, or lower another body",
               "lowered_body"};
}

Trial::Trial(const Scene& scene, const TrialSettings& settings)
    : plan_(scene.trial.value_or(TrialPlan())),
      settings_(settings),
      spills_(scene),
      forces_(scene.bodies.size()) {
  SPOONBILL_ASSERT(trial_seconds_range.contains(settings.seconds));
  if (!plan_.lowered_body.empty()) {
    lower_ = LowerBody{find_body(scene, plan_.lowered_body), plan_.lowering_speed_m_per_s};
  }
  if (!plan_.turned_body.empty() && plan_.angle_deg != 0.0) {
    turn_ = find_turn(scene, plan_);
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].motion) motions_.push_back({static_cast<int>(b), *scene.bodies[b].motion});
  }
  start(lower_ ? TrialPhase::lowering : TrialPhase::settling);
}

void Trial::start(TrialPhase phase) {
  phase_ = phase;
  phase_s_ = 0.0;
  // A body that is lowered moves, although its nodes have no velocity.
  if (phase == TrialPhase::settling) still_s_ = 0.0;
  if (phase == TrialPhase::lowering) next_ = {*lower_};
  if (phase == TrialPhase::turning) next_ = {*turn_};
  if (phase == TrialPhase::moving) next_.assign(motions_.begin(), motions_.end());
}

void Trial::start_after(TrialPhase phase) {
  if (phase == TrialPhase::settling && turn_) {
    start(TrialPhase::turning);
  } else if (phase != TrialPhase::moving && !motions_.empty()) {
    start(TrialPhase::moving);
  } else {
    start(TrialPhase::watching);
  }
}

std::optional<Command> Trial::next_command() {
  if (next_.empty()) return std::nullopt;
  Command command = std::move(next_.back());
  next_.pop_back();
  return command;
}

Status Trial::follow(const Simulation& simulation, std::uint32_t flags) {
  SPOONBILL_ASSERT(simulation.scene().bodies.size() == forces_.size());
  ++ticks_;
  phase_s_ += tick_s;
  largest_speed_m_per_s_ = 0.0;
  bool is_any_gone = false;
  for (std::size_t b = 0; b < forces_.size(); ++b) {
    is_any_gone = is_any_gone || simulation.is_gone(static_cast<int>(b));
    if (!is_movable(simulation.scene().bodies[b])) continue;
    largest_speed_m_per_s_ =
        std::max(largest_speed_m_per_s_, simulation.fastest_m_per_s(static_cast<int>(b)));
  }
  largest_penetration_m_ = std::max(largest_penetration_m_, simulation.largest_overlap_m());
  // A body that is gone has stopped only because it is not simulated any more.
  const bool is_still = largest_speed_m_per_s_ <= settled_speed_m_per_s && !is_any_gone;
  still_s_ = is_still ? still_s_ + tick_s : 0.0;
  record_forces(simulation);
  if (const char* const failure = describe_failure(flags)) {
    spills_.follow(simulation, time_s(), true);
    return Error{ErrorCode::not_converged, name_body_at_fault(simulation) + "stopped after " +
                                               std::to_string(ticks_) + " ticks: " + failure +
                                               "; use a coarser lattice or a stiffer material"};
  }
  switch (phase_) {
    case TrialPhase::lowering:
      if (phase_s_ > longest_lowering_s) {
        return Error{ErrorCode::not_converged,
                     "trial: lowered_body: nothing bore \"" + plan_.lowered_body + "\" within " +
                         number_text(longest_lowering_s) + " s; place it above another body or the ground",
                     "lowered_body"};
      }
      if (!simulation.is_moving_bodies()) start(TrialPhase::settling);
      break;
    case TrialPhase::settling:
      if (is_settled() || phase_s_ >= settings_.longest_settling_s) {
        start_after(phase_);
      }
      break;
    case TrialPhase::turning:
    case TrialPhase::moving:
      if (!simulation.is_moving_bodies()) start_after(phase_);
      break;
    case TrialPhase::watching:
      if (phase_s_ >= settings_.seconds) phase_ = TrialPhase::done;
      break;
    case TrialPhase::done:
      break;
  }
  spills_.follow(simulation, time_s(), phase_ == TrialPhase::done);
  return {};
}

void Trial::record_forces(const Simulation& simulation) {
  for (std::size_t b = 0; b < forces_.size(); ++b) {
    const int body = static_cast<int>(b);
    const Forces now{simulation.contact_force_n(body), simulation.ground_force_n(body),
                     momentum_ns(simulation, body)};
    std::vector<Forces>& ring = forces_[b];
    if (ring.size() < mean_ticks) {
      ring.push_back(now);
    } else {
      ring[(ticks_ - 1) % mean_ticks] = now;
    }
  }
}

std::optional<double> Trial::turned_deg(const Simulation& simulation) const {
  if (!turn_) return std::nullopt;
  if (phase_ > TrialPhase::turning && !motions_.empty()) return turn_->angle_deg;
  const std::optional<Pose> pose = simulation.rigid_pose(turn_->body);
  if (!pose) return std::nullopt;
  const double sine = pose->orientation.vec().dot(turn_->axis);
  return 360.0 / std::numbers::pi * std::atan2(sine, pose->orientation.w());
}

Trial::MeanForces Trial::find_mean_forces(std::size_t body) const {
  const std::vector<Forces>& ring = forces_[body];
  MeanForces mean;
  if (ring.empty()) return mean;
  for (const Forces& forces : ring) {
    mean.contact_n += forces.contact_n / static_cast<double>(ring.size());
    mean.ground_n += forces.ground_n / static_cast<double>(ring.size());
  }
  const std::size_t newest = (ticks_ - 1) % mean_ticks;
  const std::size_t oldest = ring.size() < mean_ticks ? 0 : ticks_ % mean_ticks;
  if (newest != oldest) {
    mean.inertial_n = (ring[newest].momentum_ns - ring[oldest].momentum_ns) /
                      (static_cast<double>(ring.size() - 1) * tick_s);
  }
  return mean;
}

}  // namespace spoonbill
