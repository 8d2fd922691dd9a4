#include "engine/material/contact/body_contacts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/rigid/rigid_dynamics.h"
#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {
namespace {

// Pace of contacts of a body that an implicit solver steps. The surfaces are fitted to the samples in each
// tick, so they may move slightly more or less than the constrained points. Closing at most half of a gap in
// a substep leaves a margin for this difference. A push starts from the force of the last substep, so a
// moderate rate of correction suffices; a faster one would shake bodies at rest.
constexpr double body_closing = 0.5;
constexpr ContactPace body_pace{body_closing, 400.0};
// Pace of contacts whose overlaps separate() corrects.
constexpr ContactPace separated_pace{body_closing, 0.0};

// Rate at which separate() corrects an overlap. A correction against the force of a collision adds energy, so
// it is slow. Points that push the same nodes correct together, so the part of an overlap that is corrected
// in a substep must be small.
constexpr double separation_per_s = 200.0, max_separation = 0.1;

// Part of the difference between a gap that is found and the gap of its constraint that is taken over in a
// tick. If it were taken over faster, colliding bodies would gain or lose energy; if more slowly, their drawn
// surfaces would overlap. Energy matters more in real time, and more between soft bodies, because both of
// their surfaces differ from their lattices. There, half of a difference is taken over in 14 ticks, about the
// time for which small balls of silicone touch.
constexpr double taken_over_in_tick = 0.18, taken_over_by_soft_in_real_time = 0.05;

bool is_of_frame(const BodyPoint& point) {
  return point.lattice != nullptr && point.lattice->mesh().is_frame;
}

// Returns whether the point is of a rigid body that contacts can move.
bool is_of_moving_frame(const BodyPoint& point) {
  return is_of_frame(point) && !point.lattice->has_fixed_nodes();
}

// Returns the size of a deformable body's cells; 0 for any other body.
double cell_size_m(const BodyPoint& point) {
  return point.lattice == nullptr || is_of_frame(point) ? 0.0
                                                        : static_cast<double>(point.lattice->cell_size_m());
}

double own_compliance(const BodyPoint& point) {
  return point.lattice == nullptr || is_of_frame(point) ? 0.0 : point.point.compliance(*point.lattice);
}

// Returns the relative velocity change of two points per impulse between them, 1/kg, without rigid bodies.
// Within one body, the impulses overlap in the nodes that both points use.
double mutual_compliance(const BodyPoint& first, const BodyPoint& second) {
  if (first.body != second.body) return own_compliance(first) + own_compliance(second);
  const SpringLattice& lattice = *first.lattice;
  WeightedCompliance compliance;
  for (int i = 0; i < first.point.count; ++i) {
    const int node = first.point.node[i];
    compliance.add(first.point.weight[i] - second.point.weight_of_node(node), lattice.inverse_mass(node));
  }
  for (int i = 0; i < second.point.count; ++i) {
    const int node = second.point.node[i];
    if (first.point.weight_of_node(node) != 0.0) continue;
    compliance.add(second.point.weight[i], lattice.inverse_mass(node));
  }
  return compliance.per_kg();
}

// Returns the relative velocity change of two lattices' frames per impulse between the lattices, 1/kg.
double mutual_frame_compliance(const LatticeView& first, const LatticeView& second) {
  return first.frame == second.frame ? 0.0 : frame_compliance(first) + frame_compliance(second);
}

double mutual_friction(const BodyPoint& first, const BodyPoint& second) {
  return std::min(first.point.friction(*first.lattice), second.point.friction(*second.lattice));
}

PointMobility find_mobility(const BodyPoint& point) {
  PointMobility found;
  for (int i = 0; i < point.point.count; ++i) {
    const double weight = std::abs(static_cast<double>(point.point.weight[i]));
    const auto inverse_mass = static_cast<double>(point.lattice->inverse_mass(point.point.node[i]));
    found.node_per_kg = std::max(found.node_per_kg, weight * inverse_mass);
    found.absolute_weight += weight;
  }
  return found;
}

// Returns the position of a point of a rigid body that contacts can move, when the body is at rest; zero for
// any other point.
Vector3 find_rest_m(const BodyPoint& point) {
  return is_of_moving_frame(point) ? point.point.rest_m(*point.lattice) : Vector3(Vector3::Zero());
}

Vector3 displacement_m(const BodyPoint& point) {
  return point.lattice == nullptr ? Vector3(Vector3::Zero()) : point.point.displacement_m(*point.lattice);
}

// Returns the view of a body; an empty one for the ground.
const LatticeView& view_of(std::span<const LatticeView> lattices, int body) {
  static const LatticeView ground;
  return body == ground_index ? ground : lattices[static_cast<std::size_t>(body)];
}

double cap_of(std::span<const float> caps_m_per_s, int body) {
  return body == ground_index ? infinity : static_cast<double>(caps_m_per_s[static_cast<std::size_t>(body)]);
}

// Limits a contact force of the last tick to what push and friction allow with the present normal. A force
// that pulls or is not a number becomes zero.
Vector3 limit_to_cone(const Vector3& force_n, const Vector3& normal, double friction) {
  const double push_n = force_n.dot(normal);
  if (!(push_n > 0.0) || !force_n.allFinite()) return Vector3::Zero();
  const Vector3 drag_n = force_n - push_n * normal;
  const double most_n = friction * push_n, size_n = drag_n.norm();
  return push_n * normal + (size_n > most_n ? most_n / size_n : 1.0) * drag_n;
}

}  // namespace

BodyContacts::BodyContacts(int capacity) : capacity_(static_cast<std::size_t>(capacity)), kept_(capacity_) {
  SPOONBILL_ASSERT(capacity >= 0);
  constraints_.reserve(capacity_);
  impulse_ns_.fill(Vector3::Zero());
  ground_impulse_ns_.fill(Vector3::Zero());
}

void BodyContacts::clear(std::span<const SpringLattice* const> lattices) {
  kept_.clear();
  for (const Constraint& constraint : constraints_) {
    if (constraint.sample < 0) continue;
    Vector3 apart = constraint.first.displacement_m(*lattices[constraint.first_body]);
    if (constraint.second_body != ground_index)
      apart -= constraint.second.displacement_m(*lattices[constraint.second_body]);
    const double gap_m = constraint.base_m + constraint.normal.dot(apart);
    if (!std::isfinite(gap_m)) continue;
    const bool is_mean = constraint.moved_by == MovedBy::solvers || !(time_s_ > 0.0);
    const Vector3 mean_n = is_mean ? constraint.force_n : Vector3(constraint.impulse_ns / time_s_);
    kept_.add(constraint.key(), {constraint.force_n, mean_n, constraint.normal, gap_m});
  }
  kept_.sort();
  constraints_.clear();
}

void BodyContacts::forget() {
  kept_.clear();
  constraints_.clear();
  has_searched_ = false;
}

bool BodyContacts::add(const BodyPoint& first, const BodyPoint& second, const Vector3& normal, double gap_m,
                       double deepest_new_m, int sample) {
  SPOONBILL_ASSERT_DEBUG(first.lattice != nullptr && second.lattice != nullptr);
  return add(first, second, normal, gap_m, deepest_new_m, sample, mutual_friction(first, second));
}

bool BodyContacts::add_on_ground(const BodyPoint& point, const Vector3& normal, double gap_m,
                                 double ground_friction, int sample) {
  SPOONBILL_ASSERT_DEBUG(!point.lattice->moved_by_solver() && sample >= 0);
  const double friction = std::min(ground_friction, point.point.friction(*point.lattice));
  return add(point, BodyPoint{ground_index}, normal, gap_m, infinity, sample, friction);
}

bool BodyContacts::add(const BodyPoint& first, const BodyPoint& second, const Vector3& found_normal,
                       double found_gap_m, double deepest_new_m, int sample, double friction) {
  SPOONBILL_ASSERT_DEBUG(std::abs(found_normal.squaredNorm() - 1.0) < 1e-5);
  const ContactKey key{first.body, second.body, sample};
  const Kept* const kept = sample >= 0 ? kept_.find(key) : nullptr;
  if (kept == nullptr && has_searched_ && found_gap_m < -deepest_new_m) return true;
  const bool is_folded = kept != nullptr && kept->normal.dot(found_normal) < 0.0;
  const Vector3 normal = is_folded ? kept->normal : found_normal;
  const double gap_m = is_folded ? kept->gap_m : found_gap_m;
  if (constraints_.size() == capacity_) return false;
  // A body with a prescribed motion next to an implicitly stepped one counts as such a one.
  const auto is_by_solver = [](const BodyPoint& point) {
    return point.lattice != nullptr && point.lattice->moved_by_solver();
  };
  const auto moves_in_substeps = [&](const BodyPoint& point) {
    return is_of_moving_frame(point) ||
           (point.lattice != nullptr && !is_by_solver(point) && !is_of_frame(point));
  };
  const auto is_rigid = [](const BodyPoint& point) { return point.lattice == nullptr || is_of_frame(point); };
  const bool by_solvers = !moves_in_substeps(first) && !moves_in_substeps(second);
  const double moved = normal.dot(displacement_m(first) - displacement_m(second));
  const double compliance = mutual_compliance(first, second);
  const bool yields = compliance > 0.0 || is_of_moving_frame(first) || is_of_moving_frame(second);
  const bool separates = !by_solvers && !is_by_solver(first) && !is_by_solver(second) && yields;
  const bool is_between_rigid = is_rigid(first) && is_rigid(second);
  const bool is_between_soft = !is_rigid(first) && !is_rigid(second);
  const double taken_over =
      tick_fraction_ *
      (is_real_time_ && is_between_soft ? taken_over_by_soft_in_real_time : taken_over_in_tick);
  const double difference_m =
      separates && kept != nullptr && !is_between_rigid ? (1.0 - taken_over) * (gap_m - kept->gap_m) : 0.0;
  constraints_.push_back(
      {.first_body = first.body,
       .second_body = second.body,
       .first = first.point,
       .second = second.point,
       .first_rest_m = find_rest_m(first),
       .second_rest_m = find_rest_m(second),
       .normal = normal,
       .compliance = compliance,
       .base_m = gap_m - difference_m - moved,
       .difference_m = difference_m,
       .taken_over = taken_over,
       .added_gap_m = gap_m,
       .unsolved_m = unsolved_approach_cells * std::max(cell_size_m(first), cell_size_m(second)),
       .first_mobility = find_mobility(first),
       .second_mobility = find_mobility(second),
       .friction = friction,
       .moved_by = by_solvers ? MovedBy::solvers : MovedBy::springs,
       .is_first_implicit = is_by_solver(first),
       .is_second_implicit = is_by_solver(second),
       .separates = separates,
       .sample = sample});
  if (kept == nullptr) return true;
  Constraint& added = constraints_.back();
  added.force_n = limit_to_cone(kept->force_n, normal, friction);
  if (added.is_implicit()) added.known_force_n = limit_to_cone(kept->mean_force_n, normal, friction);
  return true;
}

void BodyContacts::keep() {
  for (Constraint& constraint : constraints_) {
    if (constraint.sample < 0) {
      constraint.force_n.setZero();
      continue;
    }
    const double taken_over_m = constraint.taken_over * constraint.difference_m;
    constraint.difference_m -= taken_over_m;
    constraint.base_m += taken_over_m;
  }
}

void BodyContacts::begin(double time_s) {
  SPOONBILL_ASSERT_DEBUG(time_s > 0.0);
  time_s_ = time_s;
  for (Constraint& constraint : constraints_) {
    constraint.acted = false;
    constraint.impulse_ns.setZero();
    constraint.responded_ns = time_s * constraint.known_force_n;
    constraint.responded_force_n = constraint.force_n;
  }
  impulse_ns_.fill(Vector3::Zero());
  ground_impulse_ns_.fill(Vector3::Zero());
  has_searched_ = true;
}

double BodyContacts::largest_overlap_m() const {
  double overlap_m = 0.0;
  for (const Constraint& constraint : constraints_) {
    if (constraint.second_body == ground_index || constraint.first_body == constraint.second_body) continue;
    overlap_m = std::max(overlap_m, -constraint.added_gap_m);
  }
  return overlap_m;
}

Vector3 BodyContacts::impulse_ns(int body, double time_s) const {
  SPOONBILL_ASSERT(body >= 0 && body < lattice_capacity);
  Vector3 sum = impulse_ns_[static_cast<std::size_t>(body)];
  for (const Constraint& constraint : constraints_) {
    if (constraint.moved_by != MovedBy::solvers) continue;
    if (constraint.first_body == body) sum += time_s * constraint.force_n;
    if (constraint.second_body == body) sum -= time_s * constraint.force_n;
  }
  return sum;
}

double BodyContacts::work_j(int body, const SpringLattice& lattice, double time_s) const {
  SPOONBILL_ASSERT(body >= 0 && body < lattice_capacity);
  double sum_j = 0.0;
  const auto add = [&](const EmbeddedPoint& point, const Vector3& impulse_ns) {
    point.visit_shares(impulse_ns, [&](int node, const Vector3& share_ns) {
      sum_j -= share_ns.dot(lattice.velocity(node));
    });
  };
  for (const Constraint& constraint : constraints_) {
    const Vector3 impulse_ns =
        constraint.moved_by == MovedBy::solvers ? time_s * constraint.force_n : constraint.impulse_ns;
    if (constraint.first_body == body) add(constraint.first, impulse_ns);
    if (constraint.second_body == body) add(constraint.second, -impulse_ns);
  }
  return sum_j;
}

bool BodyContacts::are_approaching(std::span<const LatticeView> lattices, MovedBy moved_by,
                                   double time_s) const {
  return std::any_of(constraints_.begin(), constraints_.end(), [&](const Constraint& constraint) {
    if (constraint.moved_by != moved_by || !constraint.is_implicit()) return false;
    const double approach = -find_relative_m_per_s(lattices, constraint).dot(constraint.normal);
    return approach * time_s > std::max(0.0, constraint.gap_m) + constraint.unsolved_m;
  });
}

bool BodyContacts::has_constraint_between_solvers() const {
  return std::any_of(constraints_.begin(), constraints_.end(),
                     [](const Constraint& constraint) { return constraint.moved_by == MovedBy::solvers; });
}

Vector3 BodyContacts::Side::displacement_m() const {
  return view.rigid ? view.rigid->displacement_m(rest_m) : point.displacement_m(view);
}

Vector3 BodyContacts::Side::velocity_m_per_s() const {
  return view.rigid ? view.rigid->velocity_m_per_s(view.rigid->arm_m(rest_m)) : point.velocity_m_per_s(view);
}

void BodyContacts::Side::push(const Vector3& impulse_ns) const {
  view.rigid ? view.rigid->push(view.rigid->arm_m(rest_m), impulse_ns) : point.push(view, impulse_ns);
}

void BodyContacts::Side::shift(const Vector3& impulse_ns, double time_s) const {
  view.rigid ? view.rigid->shift(view, view.rigid->arm_m(rest_m), impulse_ns, time_s)
             : point.shift(view, impulse_ns, time_s);
}

BodyContacts::Side BodyContacts::first_side(std::span<const LatticeView> lattices,
                                            const Constraint& constraint) {
  return {view_of(lattices, constraint.first_body), constraint.first, constraint.first_rest_m};
}

BodyContacts::Side BodyContacts::second_side(std::span<const LatticeView> lattices,
                                             const Constraint& constraint) {
  return {view_of(lattices, constraint.second_body), constraint.second, constraint.second_rest_m};
}

double BodyContacts::find_gap_m(std::span<const LatticeView> lattices, const Constraint& constraint) {
  const Vector3 apart =
      first_side(lattices, constraint).displacement_m() - second_side(lattices, constraint).displacement_m();
  return constraint.base_m + constraint.normal.dot(apart);
}

Vector3 BodyContacts::find_relative_m_per_s(std::span<const LatticeView> lattices,
                                            const Constraint& constraint) {
  return first_side(lattices, constraint).velocity_m_per_s() -
         second_side(lattices, constraint).velocity_m_per_s();
}

void BodyContacts::find_response(std::span<const LatticeView> lattices, Constraint& constraint) {
  const Side first = first_side(lattices, constraint), second = second_side(lattices, constraint);
  double along_per_kg = 0.0, across_per_kg = 0.0;
  const auto add_response_of = [&](const Side& side, PointMobility& mobility) {
    const RigidDynamics* const rigid = side.view.rigid;
    if (rigid == nullptr) return;
    const Vector3 arm_m = rigid->arm_m(side.rest_m);
    along_per_kg += rigid->compliance(arm_m, constraint.normal);
    across_per_kg += rigid->slide_compliance(arm_m, constraint.normal);
    mobility = {rigid->largest_compliance(), 1.0};
  };
  add_response_of(first, constraint.first_mobility);
  add_response_of(second, constraint.second_mobility);
  const double of_frames_per_kg = mutual_frame_compliance(first.view, second.view);
  constraint.shift_per_kg = constraint.compliance + along_per_kg;
  constraint.normal_per_kg = constraint.shift_per_kg + of_frames_per_kg;
  constraint.slide_per_kg = constraint.compliance + across_per_kg + of_frames_per_kg;
  constraint.has_response = true;
}

std::array<double, lattice_capacity> BodyContacts::find_impacts_m_per_s(std::span<const LatticeView> lattices,
                                                                        double time_s) const {
  std::array<double, lattice_capacity> impacts{};
  for (const Constraint& constraint : constraints_) {
    if (constraint.moved_by != MovedBy::springs) continue;
    const double approach = -find_relative_m_per_s(lattices, constraint).dot(constraint.normal);
    if (!(approach * time_s > find_gap_m(lattices, constraint))) continue;
    for (const int body : {constraint.first_body, constraint.second_body}) {
      if (body == ground_index) continue;
      double& impact = impacts[static_cast<std::size_t>(body)];
      impact = std::max(impact, approach);
    }
  }
  return impacts;
}

void BodyContacts::start(std::span<const LatticeView> lattices, double h_s) {
  for (Constraint& constraint : constraints_) {
    if (constraint.moved_by != MovedBy::springs) continue;
    constraint.gap_m = find_gap_m(lattices, constraint);
    constraint.spare_m_per_s = -infinity;
    const bool has_force = !constraint.force_n.isZero(0.0) || !constraint.known_force_n.isZero(0.0);
    constraint.has_response = false;
    if (has_force || constraint.is_implicit()) find_response(lattices, constraint);
    if (!has_force) continue;
    push(lattices, constraint, h_s * constraint.force_n, h_s * constraint.known_force_n);
  }
  changed_m_per_s_.fill(0.0);
  for (Constraint& constraint : constraints_) {
    if (constraint.moved_by != MovedBy::springs || !constraint.force_n.isZero(0.0)) continue;
    if (!(constraint.gap_m > 0.0) || constraint.is_implicit()) continue;
    const double separation = find_relative_m_per_s(lattices, constraint).dot(constraint.normal);
    constraint.spare_m_per_s = separation + constraint.gap_m * body_closing / h_s;
  }
}

void BodyContacts::push(std::span<const LatticeView> lattices, Constraint& constraint, const Vector3& impulse,
                        const Vector3& known_ns) {
  const auto first = static_cast<std::size_t>(constraint.first_body);
  const auto second = static_cast<std::size_t>(constraint.second_body);
  const Side one = first_side(lattices, constraint), other = second_side(lattices, constraint);
  one.push(constraint.is_first_implicit ? Vector3(impulse - known_ns) : impulse);
  other.push(constraint.is_second_implicit ? Vector3(known_ns - impulse) : Vector3(-impulse));
  if (constraint.moved_by == MovedBy::springs) {
    if (constraint.second_body == ground_index) {
      ground_impulse_ns_[first] += impulse;
    } else {
      impulse_ns_[first] += impulse;
      impulse_ns_[second] -= impulse;
      constraint.impulse_ns += impulse;
    }
    const double size_ns = impulse.norm();
    changed_m_per_s_[first] += size_ns * (constraint.first_mobility.node_per_kg + frame_compliance(one.view));
    changed_m_per_s_[second] +=
        size_ns * (constraint.second_mobility.node_per_kg + frame_compliance(other.view));
  }
  constraint.acted = true;
}

bool BodyContacts::may_act(const Constraint& constraint) const {
  const double changed_m_per_s =
      constraint.first_mobility.absolute_weight * changed_m_per_s_[constraint.first_body] +
      constraint.second_mobility.absolute_weight * changed_m_per_s_[constraint.second_body];
  return !(constraint.spare_m_per_s > changed_m_per_s);
}

bool BodyContacts::pass(std::span<const LatticeView> lattices, const ContactPass& pass) {
  bool has_pushed = false;
  const std::span<const float> caps = pass.push_speed_caps_m_per_s;
  for (int c = 0; c < count(); ++c) {
    Constraint& constraint = constraints_[pass.is_reversed ? count() - 1 - c : c];
    if (constraint.moved_by != pass.moved_by) continue;
    if (pass.is_of_implicit && !constraint.is_implicit()) continue;
    if (pass.moved_by == MovedBy::solvers) {
      constraint.gap_m = find_gap_m(lattices, constraint);
      find_response(lattices, constraint);
    } else if (!may_act(constraint)) {
      continue;
    } else if (!constraint.has_response) {
      find_response(lattices, constraint);
    }
    const double cap = std::min(cap_of(caps, constraint.first_body), cap_of(caps, constraint.second_body));
    has_pushed |= solve(lattices, constraint, pass.h_s, cap);
  }
  return has_pushed;
}

void BodyContacts::separate(std::span<const LatticeView> lattices, double h_s,
                            std::span<const float> caps_m_per_s) {
  const double part = std::min(max_separation, separation_per_s * h_s);
  for (const Constraint& constraint : constraints_) {
    // The constraint lets at most a part of a gap close. Where other pushes close it all the same, the
    // overlap is corrected from the next substep on.
    if (!constraint.separates || constraint.sample < 0 || constraint.gap_m > 0.0) continue;
    const double gap_m = find_gap_m(lattices, constraint);
    if (!(gap_m < 0.0)) continue;
    const int first = constraint.first_body, second = constraint.second_body;
    const double cap = std::min(cap_of(caps_m_per_s, first), cap_of(caps_m_per_s, second));
    const double speed = std::min(-gap_m * part / h_s, cap);
    const Vector3 impulse = speed / constraint.shift_per_kg * constraint.normal;
    first_side(lattices, constraint).shift(impulse, h_s);
    second_side(lattices, constraint).shift(-impulse, h_s);
  }
}

void BodyContacts::shorten_solver_pass(double fraction) {
  SPOONBILL_ASSERT_DEBUG(fraction >= 0.0 && fraction <= 1.0);
  for (Constraint& constraint : constraints_) {
    if (constraint.moved_by != MovedBy::solvers) continue;
    const Vector3& before = constraint.passed_force_n;
    constraint.force_n = before + fraction * (constraint.force_n - before);
  }
}

bool BodyContacts::is_with_others(const Constraint& constraint, int body) {
  return constraint.moved_by == MovedBy::springs && constraint.second_body != ground_index &&
         (constraint.first_body == body) != (constraint.second_body == body);
}

double BodyContacts::find_assumed_work_j(int body) const {
  double work_j = 0.0;
  for (const Constraint& constraint : constraints_) {
    if (!is_with_others(constraint, body)) continue;
    work_j += constraint.normal_per_kg * (constraint.impulse_ns - constraint.responded_ns).squaredNorm();
  }
  return work_j;
}

void BodyContacts::respond(int body, double fraction, std::span<const LatticeView> lattices) {
  SPOONBILL_ASSERT_DEBUG(fraction >= 0.0 && fraction <= 1.0);
  for (Constraint& constraint : constraints_) {
    if (!is_with_others(constraint, body)) continue;
    if (fraction < 1.0) {
      const Vector3 excess_ns = (1.0 - fraction) * (constraint.impulse_ns - constraint.responded_ns);
      if (constraint.first_body == body) {
        second_side(lattices, constraint).push(excess_ns);
      } else {
        first_side(lattices, constraint).push(-excess_ns);
      }
      impulse_ns_[static_cast<std::size_t>(constraint.first_body)] -= excess_ns;
      impulse_ns_[static_cast<std::size_t>(constraint.second_body)] += excess_ns;
      constraint.impulse_ns -= excess_ns;
      constraint.force_n -= (1.0 - fraction) * (constraint.force_n - constraint.responded_force_n);
    }
    constraint.responded_ns = constraint.impulse_ns;
    constraint.responded_force_n = constraint.force_n;
  }
}

bool BodyContacts::solve(std::span<const LatticeView> lattices, Constraint& constraint, double h,
                         double cap) {
  if (constraint.normal_per_kg == 0.0) {
    constraint.force_n.setZero();
    return false;
  }
  const ContactPush state{constraint.gap_m, constraint.normal, find_relative_m_per_s(lattices, constraint),
                          1.0 / constraint.normal_per_kg, 1.0 / constraint.slide_per_kg};
  const Vector3 started = h * constraint.force_n;
  const double started_push = started.dot(constraint.normal);
  const ContactPace& pace = constraint.separates ? separated_pace : body_pace;
  const double pushed = state.normal_impulse(h, pace, cap, started_push);
  constraint.passed_force_n = constraint.force_n;
  if (pushed == 0.0 && started.isZero(0.0)) return false;
  const Vector3 drag = state.drag(constraint.friction * pushed, started_push * constraint.normal - started);
  const Vector3 impulse = pushed * constraint.normal - drag;
  constraint.force_n = impulse / h;
  constraint.spare_m_per_s = -infinity;
  push(lattices, constraint, impulse - started);
  return true;
}

bool BodyContacts::acted(int body) const {
  return std::any_of(constraints_.begin(), constraints_.end(), [&](const Constraint& constraint) {
    return constraint.acted && (constraint.first_body == body || constraint.second_body == body);
  });
}

bool BodyContacts::acted(int body, int other) const {
  return std::any_of(constraints_.begin(), constraints_.end(), [&](const Constraint& constraint) {
    const bool between = (constraint.first_body == body && constraint.second_body == other) ||
                         (constraint.first_body == other && constraint.second_body == body);
    return constraint.acted && between;
  });
}

void BodyContacts::mark_touched(int body, std::uint8_t* touched) const {
  for (const Constraint& constraint : constraints_) {
    if (!constraint.acted) continue;
    if (constraint.first_body == body) constraint.first.mark(touched);
    if (constraint.second_body == body) constraint.second.mark(touched);
  }
}

}  // namespace spoonbill
