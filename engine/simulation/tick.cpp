// A tick of a simulation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "engine/base/assert.h"
#include "engine/base/processor.h"
#include "engine/simulation/simulation_state.h"

namespace spoonbill {

namespace {

bool is_tool(const Simulation::State& s, std::size_t body) {
  return body >= s.scene.bodies.size();
}

template <class Visit>
void visit_pairs(Simulation::State& s, const Visit& visit) {
  auto pair = s.pairs.begin();
  for (std::size_t second = 1; second < s.stepped_count(); ++second) {
    for (std::size_t first = 0; first < second; ++first, ++pair) {
      if (s.bodies[first].is_immovable() && s.bodies[second].is_immovable()) continue;
      if (s.bodies[first].is_gone || s.bodies[second].is_gone) continue;
      visit(*pair, IndexedBody{static_cast<int>(first), &s.bodies[first]},
            IndexedBody{static_cast<int>(second), &s.bodies[second]}, is_tool(s, second));
    }
  }
}

// Returns whether the constraints of the last search still hold. A soft tool moves with the hand, and its
// contacts depend on what the hand does. Contacts of implicitly stepped bodies depend on a contact mass that
// changes with each impulse.
bool is_searched(const Simulation::State& s) {
  const auto stepped = s.stepped_bodies();
  const bool has_solver = std::any_of(stepped.begin(), stepped.end(),
                                      [](const BodyState& body) { return body.implicit_solver.has_value(); });
  return s.between.count() > 0 && !s.tool_is_soft() && !has_solver && s.searched.still_hold(stepped);
}

// A part of a tick, for which contacts are searched.
struct TickPart {
  int index = 0, count = 1;

  double time_s() const { return tick_s / count; }
  // Fractions of the tick at which the part begins and ends.
  double start() const { return static_cast<double>(index) / count; }
  double end() const { return static_cast<double>(index + 1) / count; }
};

// Returns the number of parts of the coming tick. Call after search_pairs(). The contacts of a tool are found
// once a tick.
int choose_parts(Simulation::State& s) {
  const auto touches = [](const HeldTool& held) { return held.contact.constraints().count() > 0; };
  if (!s.scene.sculpting.real_time || s.tool_is_soft() || touches(s.tool) || touches(s.mirrored)) return 1;
  int count = 1;
  visit_pairs(s, [&](const BodyPairContact& pair, const IndexedBody& first, const IndexedBody& second, bool) {
    count = std::max(count, pair.choose_tick_parts(*first.state, *second.state));
  });
  return count;
}

// Searches for the points of bodies that are near each other. Returns false if what the last search found
// still holds.
bool search_pairs(Simulation::State& s, double time_s) {
  if (is_searched(s)) return false;
  std::array<const SpringLattice*, lattice_capacity> lattices{};
  for (std::size_t b = 0; b < s.stepped_count(); ++b) lattices[b] = &s.stepped_bodies()[b].lattice;
  s.between.clear(lattices);
  s.pairs_overflow = false;
  s.tool_gap_m = std::numeric_limits<double>::infinity();
  visit_pairs(
      s, [&](BodyPairContact& pair, const IndexedBody& first, const IndexedBody& second, bool is_tool_pair) {
        s.pairs_overflow |= !pair.find(first, second, time_s);
        if (is_tool_pair) s.tool_gap_m = std::min(s.tool_gap_m, pair.least_gap_m());
      });
  return true;
}

// Adds constraints for the points that search_pairs() has found, and for those that are near the ground.
void add_contacts(Simulation::State& s, const ToolHold& hold, double time_s) {
  const bool tool_acts =
      !s.tool_is_soft() || s.tool.contact.acts(s.tool_gap_m <= 0.0, std::isfinite(s.tool_gap_m), hold);
  visit_pairs(s, [&](const BodyPairContact& pair, const IndexedBody& first, const IndexedBody& second,
                     bool is_tool_pair) {
    if (is_tool_pair && !tool_acts) return;
    s.pairs_overflow |= !pair.add_contacts(first, second, s.between);
  });
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    if (s.bodies[b].is_gone) continue;
    s.pairs_overflow |= !s.self[b].add_contacts({static_cast<int>(b), &s.bodies[b]}, s.between);
  }
  for (std::size_t b = 0; s.scene.ground && b < s.scene.bodies.size(); ++b) {
    if (s.bodies[b].is_gone) continue;
    const IndexedBody body{static_cast<int>(b), &s.bodies[b]};
    const Vector3& gravity = s.scene.sculpting.gravity_m_per_s2;
    const bool is_complete =
        has_sampled_ground_contact(s.bodies[b], s.scene.sculpting.real_time)
            ? s.sampled_ground[b].add_contacts(body, *s.scene.ground, gravity, time_s, s.between)
            : s.rigid_ground[b].add_contacts(body, *s.scene.ground, gravity, time_s, s.between);
    s.pairs_overflow |= !is_complete;
  }
  if (s.between.count() > 0) s.searched.remember(s.stepped_bodies());
}

// Gaps of constraints differ from those of the surfaces by less than this, in cells (see SkinPoint).
constexpr double gap_difference_cells = 0.05;

// Returns the largest overlap of two bodies that the last search found. Beside a fold of a surface, it finds
// overlaps that do not exist, and to which no constraint corresponds.
double find_overlap_m(const Simulation::State& s) {
  double found_m = 0.0, cell_m = 0.0;
  for (const BodyPairContact& pair : s.pairs) found_m = std::max(found_m, -pair.least_gap_m());
  for (const BodyState& body : s.stepped_bodies())
    cell_m = std::max(cell_m, static_cast<double>(body.lattice.cell_size_m()));
  const double held_m = s.between.largest_overlap_m();
  return found_m <= held_m + gap_difference_cells * cell_m ? found_m : held_m;
}

int find_step_division(const Sculpting& sculpting) {
  return sculpting.real_time ? sculpting.step_division : 1;
}

void relax_bodies(Simulation::State& s, std::span<const TouchingTool> tools, const TickPart& part) {
  const Sculpting& sculpting = s.scene.sculpting;
  if (s.scene.ground) {
    s.ground_contact.find(s.scene_bodies(), *s.scene.ground, sculpting, part.time_s());
  }
  const RigidMotion stays;
  std::array<RelaxedLattice, lattice_capacity> lattices{};
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    BodyState& body = s.bodies[b];
    body.loads.apply(body.lattice, body.solver());
    const double end_s = (static_cast<double>(s.tick) + part.end()) * tick_s;
    lattices[b] = {&body.lattice,
                   sculpting.gravity_m_per_s2,
                   body.is_gone ? nullptr : body.solver(),
                   body.supports.begin_step(body.lattice, end_s, part.time_s()),
                   body.is_gone ? &stays
                   : body.rigid ? &body.rigid->motion()
                                : nullptr,
                   body.rigid ? body.rigid->dynamics() : nullptr,
                   body.rigid ? body.rigid->hand() : nullptr};
  }
  const int division = find_step_division(sculpting);
  const RelaxSettings settings{s.tick,
                               (s.substeps / division + part.count - 1) / part.count,
                               part.time_s(),
                               sculpting.drag_per_s,
                               sculpting.is_critically_damped,
                               sculpting.real_time,
                               division,
                               part.index,
                               part.count};
  const RelaxReport relaxed = relax({lattices.data(), s.stepped_count()}, settings, tools, &s.between,
                                    s.scene.ground ? &s.ground_contact.contacts() : nullptr);
  s.relaxed.substeps += relaxed.substeps;
  s.relaxed.nodes_slowed |= relaxed.nodes_slowed;
  s.relaxed.speed_capped |= relaxed.speed_capped;
  if (relaxed.at_fault >= 0) s.relaxed.at_fault = relaxed.at_fault;
}

// Largest allowed distance of a node from its body's centre of mass, as a fraction of the scene's size.
constexpr double reach_fraction = 1.0;

// Adds what contacts did in a part of the tick to what they did in the tick.
void record_pushes(Simulation::State& s, double time_s) {
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    const int body = static_cast<int>(b);
    ContactPushes& pushes = s.pushes[b];
    pushes.impulse_ns += s.between.impulse_ns(body, time_s);
    if (s.scene.ground && !is_tool(s, b))
      pushes.ground_impulse_ns +=
          s.ground_contact.contacts().impulse_ns(body) + s.between.ground_impulse_ns(body);
    const SpringLattice& lattice = s.bodies[b].lattice;
    if (lattice.mesh().is_frame && lattice.has_fixed_nodes())
      pushes.work_j += s.between.work_j(body, lattice, time_s);
  }
}

// Puts a rigid body with dynamics back where it was at the start of the step, at rest, shifted by `shift_m`.
void return_to_start(BodyState& body, const Vector3& shift_m) {
  body.rigid->return_to_start(shift_m);
  body.rigid->dynamics()->place_nodes(body.lattice.view());
}

// Lowers a body level by the distance of a part of a tick, unless contacts bear its weight: then lets it go.
// A rigid body cannot settle on its contacts while it is held level, so the first push suffices.
void lower(Simulation::State& s, std::size_t index, const TickPart& part) {
  BodyState& body = s.bodies[index];
  const Vector3& gravity = s.scene.sculpting.gravity_m_per_s2;
  const Vector3 down = gravity.normalized();
  const double borne_ns = -(s.pushes[index].impulse_ns + s.pushes[index].ground_impulse_ns).dot(down);
  const double weight_ns = body.lattice.mass_kg() * gravity.norm() * part.end() * tick_s;
  if (gravity.isZero(0.0) || (body.rigid ? borne_ns > 0.0 : borne_ns >= weight_ns)) {
    body.lowering_m_per_s = 0.0;
    return;
  }
  const Vector3 shift_m = body.lowering_m_per_s * part.time_s() * down;
  if (body.rigid) {
    return_to_start(body, shift_m);
  } else {
    body.hold.keep_pose(body.lattice, body.solver(), shift_m);
  }
}

// Puts a rigid body back where it was at the start of the step, at rest, if it has no finite pose, or if it
// is free and keeps its place. Returns true if its pose was not finite.
bool hold_rigid(BodyState& body, bool keeps_place) {
  if (!body.is_movable_rigid()) return false;
  const bool is_lost = !body.rigid->is_finite();
  if (is_lost || (keeps_place && body.rigid->is_free())) return_to_start(body, Vector3::Zero());
  return is_lost;
}

// Keeps the bodies in the scene. Call after everything else has moved them in a part of the tick;
// BodyHold::begin() must have been called at its start.
void hold_bodies(Simulation::State& s, const TickPart& part) {
  const double reach_m = reach_fraction * s.scene_box.size();
  for (std::size_t b = 0; b < s.scene.bodies.size(); ++b) {
    BodyState& body = s.bodies[b];
    if (body.rigid) {
      if (hold_rigid(body, keeps_place(s.scene))) s.limited_body = static_cast<int>(b);
      if (body.lowering_m_per_s > 0.0) lower(s, b, part);
      continue;
    }
    ImplicitSolver* const solver = body.solver();
    if (body.hold.limit(body.lattice, solver, reach_m)) {
      s.limited_body = static_cast<int>(b);
      s.searched.forget();  // the forces of the constraints may be lost too
    }
    if (body.lowering_m_per_s > 0.0) lower(s, b, part);
    if (keeps_place(s.scene) && !body.lattice.has_fixed_nodes()) body.hold.keep_pose(body.lattice, solver);
  }
}

// Returns the box around the bodies at rest and the ground below them.
Box find_place(const Simulation::State& s) {
  Box place = s.scene_box;
  if (const std::optional<Ground>& ground = s.scene.ground) {
    const Vector3 centre_m = place.centre();
    place.include(centre_m - ground->normal.dot(centre_m - ground->point_m) * ground->normal);
  }
  return place;
}

// Finds the bodies that are gone from the scene, and those that a command has put back.
void find_gone_bodies(Simulation::State& s) {
  constexpr std::uint64_t interval_ticks = 16;
  if (s.tick % interval_ticks != 0) return;
  const Box place = find_place(s);
  for (BodyState& body : s.scene_bodies()) {
    const bool can_go = s.scene.sculpting.real_time && !body.rigid && !body.lattice.has_fixed_nodes() &&
                        !(body.lowering_m_per_s > 0.0);
    const bool is_gone = can_go && place.squared_distance(find_mass_centre(body.lattice).position_m) >
                                       gone_distance_m * gone_distance_m;
    if (is_gone == body.is_gone) continue;
    body.is_gone = is_gone;
    s.searched.forget();
    s.between.forget();
  }
}

std::uint32_t collect_flags(const Simulation::State& s) {
  std::uint32_t flags = tick_flag_none;
  if (s.limited_body >= 0) flags |= tick_flag_body_limited;
  if (s.relaxed.nodes_slowed) flags |= tick_flag_nodes_slowed;
  if (s.relaxed.speed_capped) flags |= tick_flag_speed_capped;
  if (s.tool.contact.overflow() || s.mirrored.contact.overflow() || s.contacts_overflow) {
    flags |= tick_flag_contact_overflow;
  }
  return flags;
}

// Clears what is reported of a tick.
void clear_report(Simulation::State& s) {
  s.limited_body = -1;
  s.relaxed = {};
  s.pushes.fill({});
  s.overlap_m = 0.0;
  s.contacts_overflow = false;
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    BodyState& body = s.bodies[b];
    std::fill(body.touched.begin(), body.touched.end(), std::uint8_t{0});
    body.supports.clear_impulses();
    if (body.rigid && body.rigid->dynamics()) body.rigid->dynamics()->clear_hand_impulse();
  }
}

void mark_touched(Simulation::State& s) {
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    std::uint8_t* const touched = s.bodies[b].touched.data();
    const int body = static_cast<int>(b);
    s.between.mark_touched(body, touched);
    if (is_tool(s, b)) continue;
    if (s.scene.ground) s.ground_contact.contacts().mark_touched(body, touched);
    s.tool.contact.constraints().mark_touched(body, touched);
    if (s.scene.symmetry.on) s.mirrored.contact.constraints().mark_touched(body, touched);
  }
}

// Returns the largest distance that the surface of a body may stay behind its lattice, m: a twentieth of the
// tool's radius, so that a stroke shows, but at least 0.05 mm and a tenth of a cell, which the eye and the
// lattice do not resolve.
double find_residual_tolerance_m(const Simulation::State& s, const BodyState& body) {
  constexpr double of_radius = 0.05, of_cell = 0.1, least_m = 5e-5;
  const double radius_m = s.scene.tool.kind == ToolKind::point ? 0.0 : s.scene.tool.radius_m;
  return std::max({least_m, of_radius * radius_m, of_cell * static_cast<double>(body.lattice.cell_size_m())});
}

// Returns the number of elements that overlap the range; 0 without a range.
int count_elements(const KnotVector& knots, const std::optional<Range<double>>& range) {
  if (!range) return 0;
  const std::vector<double>& all = knots.extended_knots();
  int count = 0;
  for (std::size_t k = 0; k + 1 < all.size(); ++k) {
    const bool is_element =
        all[k] < all[k + 1] && all[k] >= knots.domain_start() && all[k + 1] <= knots.domain_end();
    if (is_element && all[k] <= range->high && all[k + 1] >= range->low) ++count;
  }
  return count;
}

// Returns the refinement that brings a surface that is behind its lattice closer to it; empty if none can. It
// halves elements along their longer side, or along both sides if these differ by less than half. Elements
// shorter than half a cell do not follow the lattice better.
std::optional<RefineKnots> find_refinement(const BodyState& body, int index) {
  constexpr double similar = 1.5, least_cells = 0.5;
  const MappingResidual& residual = body.mapping().residual();
  if (!residual.u_range || body.mapping().catch_up_ticks_left() > 0) return std::nullopt;
  const auto [u_m, v_m] = body.mapping().element_lengths_m(residual.u, residual.v);
  const double shortest_m = 2.0 * least_cells * static_cast<double>(body.lattice.cell_size_m());
  RefineKnots refinement{index, {}, {}};
  if (u_m >= shortest_m && similar * u_m >= v_m) refinement.u = residual.u_range;
  if (v_m >= shortest_m && similar * v_m >= u_m) refinement.v = residual.v_range;
  if (!refinement.u && !refinement.v) return std::nullopt;
  const Surface& surface = body.mapping().current();
  const int rows = surface.net.rows + count_elements(surface.u, refinement.u);
  const int columns = surface.net.columns + count_elements(surface.v, refinement.v);
  if (!sculpted_control_point_count_range.contains(rows) ||
      !sculpted_control_point_count_range.contains(columns) || rows * columns > refined_control_point_limit) {
    return std::nullopt;
  }
  return refinement;
}

// Measures how far surfaces are behind their lattices: one body about sixteen times a second, each body in
// turn.
void measure_residuals(Simulation::State& s) {
  constexpr std::uint64_t interval_ticks = 64;
  if (s.tick % interval_ticks != 0) return;
  const std::size_t index = s.tick / interval_ticks % s.scene.bodies.size();
  BodyState& body = s.bodies[index];
  if (body.mesh() || body.rigid) return;
  body.mapping().measure_residual(find_residual_tolerance_m(s, body));
  const int number = static_cast<int>(index);
  body.is_refined_enough = body.mapping().residual().u_range && body.mapping().catch_up_ticks_left() == 0 &&
                           !find_refinement(body, number);
  if (!s.wanted_refinement || s.wanted_refinement->body == number) {
    s.wanted_refinement = find_refinement(body, number);
  }
}

// Returns the motion of a tool in a part of the tick.
TouchingTool in_part(const TouchingTool& tool, const TickPart& part) {
  TouchingTool moving = tool;
  const Vector3 path_m = tool.motion.end_m - tool.motion.start_m;
  if (part.index > 0) moving.motion.start_m = tool.motion.start_m + part.start() * path_m;
  if (part.index + 1 < part.count) moving.motion.end_m = tool.motion.start_m + part.end() * path_m;
  return moving;
}

void begin_rigid_steps(Simulation::State& s, double time_s) {
  for (BodyState& body : s.scene_bodies()) {
    if (body.rigid) body.rigid->begin_step(time_s);
  }
}

void carry(Simulation::State& s, const CarriedBody& carried) {
  SPOONBILL_ASSERT(carried.body >= 0 && static_cast<std::size_t>(carried.body) < s.scene.bodies.size());
  BodyState& body = s.bodies[static_cast<std::size_t>(carried.body)];
  SPOONBILL_ASSERT(body.rigid && body.rigid->hand());
  body.rigid->carry(carried.pose, tick_s);
}

void shorten_rigid_steps(Simulation::State& s, double from_s, double to_s) {
  for (BodyState& body : s.scene_bodies()) {
    if (body.rigid) body.rigid->shorten_step(from_s, to_s);
  }
}

using Tools = std::array<TouchingTool, 2>;  // that of the user's hand and its mirror image

// Moves the bodies in a part of the tick. `has_searched` tells whether search_pairs() has just found points
// that have no constraints yet.
void advance_part(Simulation::State& s, const ToolHold& hold, const Tools& tools, const TickPart& part,
                  bool has_searched) {
  s.between.set_real_time(s.scene.sculpting.real_time, 1.0 / part.count);
  if (has_searched) {
    add_contacts(s, hold, part.time_s());
  } else {
    s.between.keep();
  }
  s.between.begin(part.time_s());
  s.contacts_overflow |= s.pairs_overflow;
  s.overlap_m = std::max(s.overlap_m, find_overlap_m(s));
  for (BodyState& body : s.scene_bodies()) {
    body.hold.begin(body.lattice, keeps_place(s.scene) || body.lowering_m_per_s > 0.0);
  }
  const Tools moving{in_part(tools[0], part), in_part(tools[1], part)};
  relax_bodies(s, {moving.data(), s.scene.symmetry.on ? std::size_t{2} : std::size_t{1}}, part);
  record_pushes(s, part.time_s());
  if (s.tool_is_soft()) turn_soft_tool(s, tools[0].motion.orientation);
  hold_bodies(s, part);
  // After hold_bodies(), which would move the whole body back by what a stroke moves its centre.
  if (const auto reform = find_kernel(s.scene.tool).reform; reform && part.index + 1 == part.count) {
    reform(s, s.tool);
    if (s.scene.symmetry.on) reform(s, s.mirrored);
  }
  for (std::size_t b = 0; b < s.stepped_count(); ++b) {
    if (s.bodies[b].is_gone || (s.bodies[b].rigid && !s.bodies[b].rigid->moves())) continue;
    s.bodies[b].update_skin();
  }
  mark_touched(s);
}

}  // namespace

Reaction Simulation::advance(const ToolInput& input) {
  SPOONBILL_ASSERT(input.pose.position_m.allFinite() && input.coupling_n_per_m >= 0.0);
  const DenormalsFlushed flushed;
  State& s = *state_;
  const bool both = s.scene.symmetry.on;
  Tools tools{};
  const ToolHold hold = make_hold(input);
  tools[0] = touch(s, s.tool, hold, input.coupling_n_per_m);
  if (both) {
    tools[1] = touch(s, s.mirrored, make_mirrored_hold(s.scene.symmetry, input), input.coupling_n_per_m);
  }
  clear_report(s);
  find_gone_bodies(s);
  if (input.carried) carry(s, *input.carried);
  begin_rigid_steps(s, tick_s);
  for (BodyState& body : s.scene_bodies()) {
    if (!body.mesh()) body.mapping().catch_up();
  }
  bool has_searched = search_pairs(s, tick_s);
  const int parts = has_searched ? choose_parts(s) : 1;
  for (int p = 0; p < parts; ++p) {
    const TickPart part{p, parts};
    if (p > 0) {
      begin_rigid_steps(s, part.time_s());
      has_searched = search_pairs(s, part.time_s());
    } else if (parts > 1) {
      shorten_rigid_steps(s, tick_s, part.time_s());
    }
    advance_part(s, hold, tools, part, has_searched);
  }
  measure_residuals(s);
  ++s.tick;

  react(s, input);
  s.reaction.mirror_touching = both && s.mirrored.contact.constraints().acted();
  s.reaction.flags = collect_flags(s);
  return s.reaction;
}

}  // namespace spoonbill
