#include "app/study/case_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/processor.h"
#include "engine/base/text.h"
#include "engine/scene/place_body.h"
#include "engine/simulation/body_hold.h"
#include "engine/trial/body_measures.h"
#include "engine/trial/height_map.h"
#include "engine/trial/trial_report.h"

namespace spoonbill {
namespace {

const Vector3 up = Vector3::UnitY();
constexpr std::size_t food_index = 0, spoon_index = 1;  // in the scene
constexpr double laying_gap_m = 0.3e-3;
constexpr double lowering_speed_m_per_s = 0.02;
// Cells along the shortest side of the food whose lattice is not refined.
constexpr int usual_cells_across = 5;

template <class Named>
const Named& find_named(const std::vector<Named>& list, const std::string& name) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Named& named) { return named.name == name; });
  SPOONBILL_ASSERT(found != list.end());
  return *found;
}

// Returns the distance by which the food can be lowered until it touches the spoon; empty if no part of it is
// over the spoon.
std::optional<double> find_gap_m(const Surface& food, const Surface& spoon) {
  constexpr double cell_m = 0.4e-3;
  const HeightMap top(spoon, up, cell_m), bottom(food, -up, cell_m);
  double gap_m = infinity;
  for (int row = 0; row < bottom.rows(); ++row) {
    for (int column = 0; column < bottom.columns(); ++column) {
      if (bottom.cell(row, column).height_m == -infinity) continue;
      const Vector3 point = bottom.point(row, column);
      const double height_m = top.cell_at(top.plan(point)).height_m;
      if (height_m != -infinity) gap_m = std::min(gap_m, up.dot(point) - height_m);
    }
  }
  return gap_m < infinity ? std::optional(gap_m) : std::nullopt;
}

Pose turn_about(const Vector3& point_m, const Vector3& axis, double angle_deg) {
  const Quaternion turn(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, axis));
  return {point_m - turn * point_m, turn};
}

Body make_spoon(const StudySpoon& spoon, const StudyCase& study_case, Bowl& bowl) {
  Body body = spoon.body;
  bowl = spoon.bowl;
  body.name = "spoon";
  body.kind = BodyKind::fixed;
  body.rim = bowl.rim;
  change_bowl(spoon.bowl, study_case.bowl, body.surface);
  const double pitch_deg = study_case.pitch_deg + (study_case.is_laid_after ? study_case.tilt_deg : 0.0);
  if (pitch_deg != 0.0) {
    const Pose turn = turn_about(bowl.centre_m, bowl.tilt_axis(), pitch_deg);
    move_body(turn, body);
    bowl.normal = turn.orientation * bowl.normal;
    bowl.front = turn.orientation * bowl.front;
  }
  body.material.friction = study_case.friction;
  for (MaterialRegion& region : body.regions) region.friction.reset();
  return body;
}

Body make_food(const StudyFood& food, const StudyCase& study_case) {
  Body body = food.body;
  body.name = "food";
  scale_body(Vector3::Constant(study_case.helping), bounding_box(body.surface.net).centre(), body);
  body.material.friction = study_case.friction;
  body.material.youngs_modulus_pa *= study_case.stiffness;
  const Vector3 size_m = bounding_box(body.surface.net).extent();
  const double cell_m = size_m.minCoeff() / (usual_cells_across + study_case.refinement);
  body.lattice = {};
  body.lattice.cells = LatticeCells::box;
  std::array<int, 3> counts{};
  for (int axis = 0; axis < 3; ++axis) {
    counts[static_cast<std::size_t>(axis)] =
        std::clamp(static_cast<int>(std::lround(size_m[axis] / cell_m)) + 1, 3, node_count_range.high);
  }
  body.lattice.counts = counts;
  return body;
}

// Turns food about the vertical, so that its x axis lies along the bowl, to a degree: the front of a bowl is
// not known better. Food has no front of its own.
void turn_along(const Vector3& front, Body& food) {
  Vector3 along(front.x(), 0.0, front.z());
  if (along.x() < 0.0) along = -along;
  const double angle_deg = std::atan2(-along.z(), along.x()) * 180.0 / std::numbers::pi;
  if (std::abs(angle_deg) > 1.0) {
    move_body(turn_about(bounding_box(food.surface.net).centre(), up, angle_deg), food);
  }
}

// Returns the side of the rim of a point at an offset from the rim's centre (Spill::outside_m). The sides of
// a long bowl begin at its diagonals.
RimSide find_side(const Vector2& offset_m, const Bowl& bowl) {
  const double ahead = offset_m.x() / bowl.length_m, left = offset_m.y() / bowl.width_m;
  if (std::abs(ahead) >= std::abs(left)) return ahead >= 0.0 ? RimSide::front : RimSide::back;
  return left >= 0.0 ? RimSide::left : RimSide::right;
}

// Tells whether the centre of mass of a body has stayed within rest_distance_m for rest_time_s. Jelly that
// hangs over a rim rocks on for seconds by some micrometres; the speed of its nodes would not call that rest.
class RestWatch {
 public:
  // Called after each tick.
  void follow(const Simulation& simulation, int body) {
    if (simulation.tick() % ticks_between != 0) return;
    centres_.push_back(find_mass_centre(simulation.lattice(body)).position_m);
    if (centres_.size() > length) centres_.pop_front();
  }
  void start_over() { centres_.clear(); }
  bool is_at_rest() const {
    if (centres_.size() < length) return false;
    Box box;
    for (const Vector3& centre : centres_) box.include(centre);
    return box.size() <= case_rest_distance_m;
  }

 private:
  static constexpr std::uint64_t ticks_between = 10;
  static constexpr auto length = static_cast<std::size_t>(case_rest_s / (ticks_between * tick_s) + 1.5);
  std::deque<Vector3> centres_;
};

CaseResult failed(std::string reason) {
  CaseResult result;
  result.failure = std::move(reason);
  return result;
}

}  // namespace

Result<Scene> make_case_scene(const StudyPlan& plan, const StudyCase& study_case) {
  Bowl bowl;
  Scene scene;
  scene.bodies.push_back(make_food(find_named(plan.foods, study_case.food), study_case));
  scene.bodies.push_back(make_spoon(find_named(plan.spoons, study_case.spoon), study_case, bowl));
  Body& food = scene.bodies[food_index];
  const Body& spoon = scene.bodies[spoon_index];
  const Box spoon_box = bounding_box(spoon.surface.net);
  turn_along(bowl.front, food);
  Vector3 place_m = bowl.centre_m - bounding_box(food.surface.net).centre();
  place_m.y() = spoon_box.high.y() - bounding_box(food.surface.net).low.y();
  move_body({place_m, Quaternion::Identity()}, food);
  const std::optional<double> gap_m = find_gap_m(food.surface, spoon.surface);
  if (!gap_m) return Error{ErrorCode::mismatch, "no part of the food is over the bowl"};
  move_body({(laying_gap_m - *gap_m) * up, Quaternion::Identity()}, food);
  const double turn_deg = study_case.is_laid_after ? 0.0 : study_case.tilt_deg;
  scene.trial =
      TrialPlan{"food", lowering_speed_m_per_s, "spoon", bowl.centre_m, bowl.tilt_axis(), turn_deg, 30.0};
  scene.sculpting.step_division = study_case.step_division;
  return make_trial_scene(std::move(scene), turn_deg);
}

Result<CaseResult> run_case(const StudyPlan& plan, const StudyCase& study_case, const CaseWatch& watch,
                            Scene* end) {
  auto scene = make_case_scene(plan, study_case);
  if (!scene) return failed(scene.error().message);
  auto made = Simulation::make(std::move(scene).value(), best_instruction_set());
  if (!made) return failed(made.error().message);
  Simulation simulation = std::move(made).value();
  if (Status ready = check_trial_start(simulation); !ready) return failed(ready.error().message);
  TrialSettings settings;
  settings.seconds = case_motion_s;
  settings.longest_settling_s = case_settling_s;
  Trial trial(simulation.scene(), settings);
  const SpringLattice& lattice = simulation.lattice(food_index);
  CaseResult result;
  result.nodes = lattice.mesh().node_count();
  result.food_kg = lattice.mass_kg();
  std::optional<double> turn_s;
  if (study_case.is_laid_after) turn_s = 0.0;
  RestWatch rest;
  while (trial.phase() != TrialPhase::done && trial.time_s() < case_motion_s) {
    while (const std::optional<Command> command = trial.next_command()) {
      if (Status applied = simulation.apply(*command); !applied) return failed(applied.error().message);
    }
    if (!turn_s && trial.phase() > TrialPhase::settling) turn_s = trial.time_s();
    const Reaction reaction = simulation.advance(trial_input());
    if (Status held = trial.follow(simulation, reaction.flags); !held) return failed(held.error().message);
    result.largest_contact_n =
        std::max(result.largest_contact_n, simulation.contact_force_n(food_index).norm());
    if (watch && !watch(trial, simulation)) return Error{ErrorCode::cancelled, "stopped"};
    const Spill* const spill = trial.spill(food_index);
    if (spill && judge(*spill, false) == Verdict::leaves) break;
    rest.follow(simulation, food_index);
    if (trial.phase() != TrialPhase::watching) rest.start_over();
    if (rest.is_at_rest()) break;
  }
  if (end) {
    *end = simulation.scene();
    simulation.write_scene(*end);
  }
  const TrialBodyReport food = report_on(trial, simulation).bodies[food_index];
  if (!food.centre_of_mass_m.allFinite()) return failed("the food's lattice is not finite");
  if (!food.spill) return failed("the food was never inside the rim");
  const Spill& spill = *food.spill;
  result.verdict = judge(spill, rest.is_at_rest());
  // Food that has left may be cut by the rim as it falls, which does not change the verdict.
  if (food.inverted_cells > 0 && result.verdict != Verdict::leaves)
    return failed("the food's lattice is tangled");
  result.outside_kg = spill.outside_fraction * result.food_kg;
  result.left_kg = spill.spilled_fraction * result.food_kg;
  if (spill.outside_fraction > 0.0) {
    result.side = find_side(spill.outside_m, find_named(plan.spoons, study_case.spoon).bowl);
  }
  result.margin_m = spill.margin_m;
  if (spill.first_spill_s || spill.left_s) {
    const double first_s = std::min(spill.first_spill_s.value_or(infinity), spill.left_s.value_or(infinity));
    result.first_spill_s = first_s - turn_s.value_or(trial.time_s());
  }
  result.motion_s = trial.time_s();
  result.largest_speed_m_per_s = trial.largest_speed_m_per_s();
  return result;
}

}  // namespace spoonbill
