#include "engine/material/statics/static_solver.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "engine/base/assert.h"
#include "engine/material/statics/static_system.h"

namespace spoonbill {
namespace {

using Coordinates = StaticSystem::Coordinates;

// Of the largest pivot: a smaller one means that nothing holds a motion.
constexpr double least_pivot = 1e-13;
constexpr double least_load_step = 1e-3;
// Newton steps for one step of the loads.
constexpr int steps_a_load = 40;
constexpr int halvings = 12;
// Of the fall of energy that the slope promises.
constexpr double enough_fall = 1e-4;
// Of an energy that is a sum over cells.
constexpr double rounding = 1e-13;

class Equilibrium {
 public:
  Equilibrium(StaticSystem& system, const StaticLoads& loads, const StaticSettings& settings)
      : system_(&system), loads_(&loads), settings_(&settings) {
    factors_.analyzePattern(system.stiffness());
  }

  // Whether every motion is held, at rest.
  bool is_held() {
    system_->respond(system_->rest(), Tangent::plain);
    factors_.factorize(system_->stiffness());
    return factors_.info() == Eigen::Success &&
           factors_.vectorD().minCoeff() > least_pivot * factors_.vectorD().maxCoeff();
  }

  // From `at` on, with this share of the loads.
  bool find(double share, Coordinates& at) {
    double first = 0.0;
    for (int step = 0; step < steps_a_load && steps_ < settings_->step_limit; ++step) {
      const StaticSystem::Forces forces = take(at, Tangent::stressed);
      const Coordinates loads = share * system_->loads(*loads_, at);
      const Coordinates unbalanced = system_->free_of(loads - forces.held_so);
      const double size = std::max(forces.size, loads.norm());
      if (!std::isfinite(size)) return false;
      if (unbalanced.norm() <= settings_->tolerance * size) return true;
      ++steps_;
      first = std::max(first, unbalanced.norm() / size);
      if (!report(share, unbalanced.norm() / size, first)) {
        stopped_ = true;
        return false;
      }
      if (!factor(at)) return false;
      if (!descend(factors_.solve(unbalanced), loads, unbalanced, at)) return false;
    }
    return false;
  }

  int steps() const { return steps_; }
  bool may_go_on() const { return steps_ < settings_->step_limit; }
  bool stopped() const { return stopped_; }

 private:
  // Newton's method comes nearer by orders of magnitude, the more the nearer it is.
  bool report(double share, double unbalanced, double first) const {
    if (!settings_->progress.is_watched()) return true;
    const double orders = std::log(first / settings_->tolerance);
    return settings_->progress.report(orders > 0.0 ? share * std::log(first / unbalanced) / orders : 0.0);
  }

  StaticSystem::Forces take(const Coordinates& at, Tangent tangent) { return system_->respond(at, tangent); }

  // Where stress makes the tangent indefinite, Newton's step need not lead downhill.
  bool factor(const Coordinates& at) {
    factors_.factorize(system_->stiffness());
    if (factors_.info() == Eigen::Success && factors_.vectorD().minCoeff() > 0.0) return true;
    take(at, Tangent::plain);
    factors_.factorize(system_->stiffness());
    return factors_.info() == Eigen::Success && factors_.vectorD().minCoeff() > 0.0;
  }

  bool descend(const Coordinates& step, const Coordinates& loads, const Coordinates& unbalanced,
               Coordinates& at) const {
    const double fall = unbalanced.dot(step), before = potential(at, loads);
    double share = 1.0;
    for (int halving = 0; halving <= halvings; ++halving, share *= 0.5) {
      Coordinates next = at;
      system_->move(step, share, next);
      const double enough = before + rounding * std::abs(before) - enough_fall * share * fall;
      if (!(potential(next, loads) <= enough)) continue;
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
  Eigen::SimplicialLDLT<StaticSystem::Stiffness> factors_;
  int steps_ = 0;
  bool stopped_ = false;
};

Status check_held(const StaticBody& body, const std::vector<HeldAxis>& held) {
  for (const HeldAxis& axis : held) {
    if (axis.node < 0 || axis.node >= body.mesh().node_count() || axis.axis < 0 || axis.axis > 2) {
      return Error{"held axis " + std::to_string(axis.axis) + " of node " + std::to_string(axis.node) +
                   ": the body has no such node or axis"};
    }
    if (!std::isfinite(axis.displacement_m)) {
      return Error{"held axis of node " + std::to_string(axis.node) + ": its displacement is no number"};
    }
  }
  return {};
}

StaticResult result_of(StaticSystem& system, const StaticLoads& loads, const std::vector<HeldAxis>& held,
                       const Coordinates& at) {
  StaticResult result;
  const Coordinates borne = system.respond(at, Tangent::plain).held_so - system.loads(loads, at);
  result.energy_j = system.energy_j(at);
  for (int n = 0; n < system.body().mesh().node_count(); ++n) {
    result.displacement_m.emplace_back(at.segment<3>(3 * static_cast<Eigen::Index>(n)));
  }
  result.reaction_n.assign(result.displacement_m.size(), Vector3::Zero());
  for (const HeldAxis& axis : held) {
    result.reaction_n[static_cast<std::size_t>(axis.node)][axis.axis] =
        borne[3 * static_cast<Eigen::Index>(axis.node) + axis.axis];
  }
  return result;
}

}  // namespace

Result<StaticResult> rest_under_load(const StaticBody& body, const StaticLoads& loads,
                                     const std::vector<HeldAxis>& held, const StaticSettings& settings) {
  SPOONBILL_ASSERT(settings.tolerance > 0.0 && settings.step_limit >= 1);
  if (const Status status = check_held(body, held); !status.ok()) return status.error();
  StaticSystem system(body, held);
  Equilibrium equilibrium(system, loads, settings);
  if (!equilibrium.is_held()) {
    return Error{
        "supports: the body can move or turn freely; hold at least three nodes that are not in line"};
  }
  Coordinates at = system.rest();
  double share = 0.0, step = 1.0;
  while (share < 1.0) {
    const double next = std::min(1.0, share + step);
    Coordinates tried = at;
    system.hold(next, tried);
    if (equilibrium.find(next, tried)) {
      at = tried;
      share = next;
      step *= 2.0;
      continue;
    }
    if (equilibrium.stopped()) return Progress::stopped();
    step *= 0.25;
    if (step < least_load_step || !equilibrium.may_go_on()) {
      return Error{"loads: the body finds no rest beyond " + std::to_string(static_cast<int>(100.0 * share)) +
                   " % of them; reduce them or hold the body elsewhere"};
    }
  }
  StaticResult result = result_of(system, loads, held, at);
  result.newton_steps = equilibrium.steps();
  return result;
}

}  // namespace spoonbill
