#include "engine/material/statics/static_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "engine/base/assert.h"
#include "engine/material/statics/static_system.h"
#include "engine/material/statics/stiffness_factors.h"

namespace spoonbill {
namespace {

using Coordinates = StaticSystem::Coordinates;

// Smallest pivot of a fixed body's stiffness, relative to the largest pivot. A smaller pivot means that a
// rigid motion is free.
constexpr double min_pivot = 1e-13;
constexpr double min_load_step = 1e-3;
// Largest number of Newton steps for one load step.
constexpr int steps_per_load = 40;
constexpr int step_halvings = 12;
// Smallest accepted decrease of the energy, relative to the decrease that the slope predicts.
constexpr double min_decrease = 1e-4;
// Relative rounding error of the energy, which is a sum over cells.
constexpr double rounding = 1e-13;

class Equilibrium {
 public:
  Equilibrium(StaticSystem& system, const StaticLoads& loads, const StaticSettings& settings)
      : system_(&system), loads_(&loads), settings_(&settings) {
    factors_.analyzePattern(system.stiffness());
  }

  double work() const { return factors_.work(); }

  // Returns whether the supports prevent every rigid motion of the rest shape. Also returns false if
  // cancelled().
  bool is_fixed() {
    system_->respond(system_->rest(), Tangent::plain);
    return factor() && factors_.has_pivots_above(min_pivot);
  }

  // Finds the equilibrium under this fraction of the loads, starting from `at`. Returns false if it finds
  // none.
  bool solve(double fraction, Coordinates& at) {
    double first = 0.0;
    for (int step = 0; step < steps_per_load && steps_ < settings_->step_limit; ++step) {
      const StaticSystem::Forces forces = respond(at, Tangent::stressed);
      const Coordinates loads = fraction * system_->loads(*loads_, at);
      const Coordinates unbalanced = system_->restrict_to_free(loads - forces.restoring);
      const double size = std::max(forces.size, loads.norm());
      if (!std::isfinite(size)) return false;
      if (unbalanced.norm() <= settings_->tolerance * size) return true;
      ++steps_;
      first = std::max(first, unbalanced.norm() / size);
      set_done(fraction, unbalanced.norm() / size, first);
      if (!factor_tangent(at)) return false;
      if (!descend(factors_.solve(unbalanced), loads, unbalanced, at)) return false;
    }
    return false;
  }

  int steps() const { return steps_; }
  bool has_steps_left() const { return steps_ < settings_->step_limit; }
  bool cancelled() const { return cancelled_; }

 private:
  // Sets the progress to the orders of magnitude by which the unbalanced force has fallen, divided by the
  // required orders, times the fraction of the loads. Newton's method gains more orders with each step.
  void set_done(double fraction, double unbalanced, double first) {
    const double orders = std::log(first / settings_->tolerance);
    done_ = orders > 0.0 ? fraction * std::log(first / unbalanced) / orders : 0.0;
  }

  StaticSystem::Forces respond(const Coordinates& at, Tangent tangent) {
    return system_->respond(at, tangent);
  }

  // Factorises the current stiffness. Returns false if the caller has cancelled.
  bool factor() {
    cancelled_ = !factors_.factor(system_->stiffness(), [this] { return settings_->progress.report(done_); });
    return !cancelled_;
  }

  // Factorises the tangent. If stress makes the tangent indefinite, Newton's step may not descend. The
  // tangent without the contribution of stress (Tangent::plain) is then used instead.
  bool factor_tangent(const Coordinates& at) {
    if (!factor()) return false;
    if (factors_.has_pivots_above(0.0)) return true;
    respond(at, Tangent::plain);
    return factor() && factors_.has_pivots_above(0.0);
  }

  bool descend(const Coordinates& step, const Coordinates& loads, const Coordinates& unbalanced,
               Coordinates& at) const {
    const double fall = unbalanced.dot(step), before = potential(at, loads);
    double fraction = 1.0;
    for (int halving = 0; halving <= step_halvings; ++halving, fraction *= 0.5) {
      Coordinates next = at;
      system_->move(step, fraction, next);
      const double threshold = before + rounding * std::abs(before) - min_decrease * fraction * fall;
      if (!(potential(next, loads) <= threshold)) continue;
      at = next;
      return true;
    }
    return false;
  }

  double potential(const Coordinates& at, const Coordinates& loads) const {
    return system_->energy_j(at) - loads.dot(at);
  }

  StaticSystem* system_;
  const StaticLoads* loads_;
  const StaticSettings* settings_;
  StiffnessFactors factors_;
  int steps_ = 0;
  double done_ = 0.0;  // progress of the whole solve
  bool cancelled_ = false;
};

Status check_fixed(const StaticBody& body, const std::vector<FixedAxis>& fixed) {
  for (const FixedAxis& axis : fixed) {
    if (axis.node < 0 || axis.node >= body.mesh().node_count() || axis.axis < 0 || axis.axis > 2) {
      return Error{ErrorCode::unknown, "fixed axis " + std::to_string(axis.axis) + " of node " +
                                           std::to_string(axis.node) + ": the body has no such node or axis"};
    }
    if (!std::isfinite(axis.displacement_m)) {
      return Error{ErrorCode::out_of_range, "fixed axis of node " + std::to_string(axis.node) +
                                                ": its displacement is not a finite number"};
    }
  }
  return {};
}

// Returns an error that suggests a number of nodes with which a factorisation needs no more multiplications
// than the limit. If a lattice is refined equally in all directions, the work grows with the number of nodes
// to the power of at most 7/3, as for a band matrix.
Error too_large(int nodes, double work, double limit) {
  constexpr double reserve = 0.9, exponent = 3.0 / 7.0;
  const int enough = static_cast<int>(reserve * nodes * std::pow(limit / work, exponent)) / 100 * 100;
  return Error{ErrorCode::too_many,
               "lattice: " + std::to_string(nodes) + " nodes in this shape take too long; use about " +
                   std::to_string(std::max(enough, 100)) + " in total (node_budget or nodes)",
               "lattice"};
}

StaticResult make_result(StaticSystem& system, const StaticLoads& loads, const std::vector<FixedAxis>& fixed,
                         const Coordinates& at) {
  StaticResult result;
  const Coordinates reactions = system.respond(at, Tangent::plain).restoring - system.loads(loads, at);
  result.energy_j = system.energy_j(at);
  for (int n = 0; n < system.body().mesh().node_count(); ++n) {
    result.displacement_m.emplace_back(at.segment<3>(3 * static_cast<Eigen::Index>(n)));
  }
  result.reaction_n.assign(result.displacement_m.size(), Vector3::Zero());
  for (const FixedAxis& axis : fixed) {
    result.reaction_n[static_cast<std::size_t>(axis.node)][axis.axis] =
        reactions[3 * static_cast<Eigen::Index>(axis.node) + axis.axis];
  }
  return result;
}

}  // namespace

Result<StaticResult> rest_under_load(const StaticBody& body, const StaticLoads& loads,
                                     const std::vector<FixedAxis>& fixed, const StaticSettings& settings) {
  SPOONBILL_ASSERT(settings.tolerance > 0.0 && settings.step_limit >= 1);
  if (const Status status = check_fixed(body, fixed); !status.ok()) return status.error();
  StaticSystem system(body, fixed);
  if (system.is_fixed_everywhere()) {
    Coordinates moved = system.rest();
    system.set_fixed(1.0, moved);
    StaticResult result = make_result(system, loads, fixed, moved);
    result.is_fixed_everywhere = true;
    return result;
  }
  Equilibrium equilibrium(system, loads, settings);
  if (equilibrium.work() > settings.work_limit) {
    return too_large(body.mesh().node_count(), equilibrium.work(), settings.work_limit);
  }
  if (!equilibrium.is_fixed()) {
    if (equilibrium.cancelled()) return Progress::stopped();
    return Error{ErrorCode::too_few,
                 "supports: the body can move or turn freely; fix at least three nodes that are not in line",
                 "supports"};
  }
  Coordinates at = system.rest();
  double fraction = 0.0, step = 1.0;
  while (fraction < 1.0) {
    const double next = std::min(1.0, fraction + step);
    Coordinates tried = at;
    system.set_fixed(next, tried);
    if (equilibrium.solve(next, tried)) {
      at = tried;
      fraction = next;
      step *= 2.0;
      continue;
    }
    if (equilibrium.cancelled()) return Progress::stopped();
    step *= 0.25;
    if (step < min_load_step || !equilibrium.has_steps_left()) {
      return Error{ErrorCode::not_converged,
                   "loads: no equilibrium beyond " + std::to_string(static_cast<int>(100.0 * fraction)) +
                       " % of them; reduce them or fix more of the body",
                   "loads"};
    }
  }
  StaticResult result = make_result(system, loads, fixed, at);
  result.newton_steps = equilibrium.steps();
  return result;
}

}  // namespace spoonbill
