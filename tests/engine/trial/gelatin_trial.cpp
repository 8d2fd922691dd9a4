#include "tests/engine/trial/gelatin_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "engine/simulation/body_hold.h"
#include "engine/trial/trial_report.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr int skin_samples_each_way = 120;

Body bearer_of(const GelatinTrial& trial) {
  Material steel = bundled_material("steel-304");
  steel.friction = trial.friction;
  if (!trial.bowl_m) {
    const PlateSize size;
    Body plate = stock_body("bearer", size, {0.0, -0.5 * size.thickness_m, 0.0}, steel, 300);
    plate.kind = BodyKind::fixed;
    return plate;
  }
  const BowlSize size{0.06, 0.042, *trial.bowl_m, 1e-3};
  Body bowl = stock_body("bearer", size, {0.0, -0.5 * *trial.bowl_m - 1e-3, 0.0}, steel, 300);
  bowl.kind = BodyKind::fixed;
  bowl.rim = bowl_shape(size)->rim;
  return bowl;
}

Vector3 find_nodes_mean_m(const SpringLattice& lattice) {
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (!(lattice.mass(n) > 0.0f)) continue;
    sum += lattice.position(n);
    ++count;
  }
  return sum / count;
}

}  // namespace

std::string describe(const GelatinTrial& trial) {
  const auto rounded = [](double value) { return std::to_string(std::lround(value)); };
  std::string text = trial.bowl_m ? "bowl of " + rounded(1e3 * *trial.bowl_m) + " mm" : "plate";
  text +=
      ", friction " + rounded(100.0 * trial.friction) + " %, " + std::to_string(trial.node_budget) + " nodes";
  if (trial.tilt_deg != 0.0) text += ", " + rounded(trial.tilt_deg) + " degrees";
  if (trial.fall_m) text += ", falls " + rounded(1e3 * *trial.fall_m) + " mm";
  if (!trial.damped) text += ", not damped";
  if (trial.step_division != 1) text += ", step / " + std::to_string(trial.step_division);
  return text;
}

Scene gelatin_scene(const GelatinTrial& trial) {
  Material material = made_elastic(bundled_material("gelatin-20-1"));
  material.friction = trial.friction;
  if (!trial.damped) material.damping_time_s = 0.0;
  Scene scene;
  scene.bodies = {stock_body("gelatin", BoxSize{{0.03, gelatin_height_m, 0.024}, trial.rounding_m},
                             {0.0, 0.5 * gelatin_height_m + 1e-4, 0.0}, material, trial.node_budget),
                  bearer_of(trial)};
  scene.sculpting.step_division = trial.step_division;
  TrialPlan plan{"gelatin", 0.01, "bearer", Vector3::Zero(), Vector3::UnitZ(), trial.tilt_deg, 30.0};
  if (trial.fall_m) {
    plan.lowered_body.clear();
    const Vector3 shift = (*trial.fall_m - find_gelatin_gap_m(scene)) * Vector3::UnitY();
    scene.bodies[0].surface = placed(scene.bodies[0].surface, {shift, Quaternion::Identity()});
  }
  scene.trial = plan;
  return make_trial_scene(scene, {}).value();
}

double find_gelatin_gap_m(const Scene& scene) {
  return find_gap_along_m(ExactDistance(scene.bodies[1].surface),
                          sample_skin_points(scene.bodies[0].surface, skin_samples_each_way),
                          -Vector3::UnitY());
}

TopGauge::TopGauge(const Surface& at_rest) {
  for (const SkinPoint& point : sample_skin_points(at_rest, skin_samples_each_way)) {
    areas_m2_.push_back(point.normal.y() > 0.99 ? point.area_m2 : 0.0);
  }
}

double TopGauge::find_height_m(const Surface& surface) const {
  const std::vector<SkinPoint> points = sample_skin_points(surface, skin_samples_each_way);
  double sum = 0.0, area_m2 = 0.0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    sum += areas_m2_[p] * points[p].point_m.y();
    area_m2 += areas_m2_[p];
  }
  return sum / area_m2;
}

GelatinRest run_gelatin(const GelatinTrial& wanted) {
  constexpr double longest_s = 10.0;
  Simulation simulation = make_simulation(gelatin_scene(wanted));
  Trial trial(simulation.scene(), {longest_s, longest_s});
  const TopGauge top(simulation.surface(0));
  const double touching_top_m =
      top.find_height_m(simulation.surface(0)) - find_gelatin_gap_m(simulation.scene());
  GelatinRest rest;
  Vector3 from_m = find_mass_centre(simulation.lattice(0)).position_m;
  bool settled_before_turn = true;
  double since_s = 0.0;
  int still_ticks = 0;
  while (trial.phase() != TrialPhase::done && still_ticks < static_cast<int>(Trial::mean_force_s / tick_s)) {
    const TrialPhase phase = trial.phase();
    while (const auto command = trial.next_command()) EXPECT_TRUE(simulation.apply(*command).ok());
    const Reaction reaction = simulation.advance(trial_input());
    if (const Status held = trial.follow(simulation, reaction.flags); !held) {
      rest.stopped = held.error().message;
      break;
    }
    if (phase == TrialPhase::settling && trial.phase() != phase) {
      settled_before_turn = trial.is_settled();
      rest.settled = trial.is_settled();
      rest.settled_s = trial.time_s() - since_s;
      rest.sag_m = touching_top_m - top.find_height_m(simulation.surface(0));
      if (trial.phase() == TrialPhase::turning) {
        from_m = find_mass_centre(simulation.lattice(0)).position_m;
        rest.settled = false;
      }
    }
    if (trial.phase() != phase) since_s = trial.time_s();
    if (trial.phase() != TrialPhase::watching) continue;
    if (!rest.settled && trial.is_settled()) {
      rest.settled = settled_before_turn;
      rest.settled_s = trial.time_s() - since_s;
    }
    if (trial.is_settled()) ++still_ticks;
  }
  const SpringLattice& lattice = simulation.lattice(0);
  const TrialReport report = report_on(trial, simulation);
  rest.speed_m_per_s = trial.largest_speed_m_per_s();
  rest.inverted_cells = report.inverted_cells;
  rest.smallest_jacobian = report.bodies[0].smallest_jacobian;
  rest.depth_m = find_depth_m(ExactDistance(simulation.surface(1)),
                              sample_skin_points(simulation.surface(0), skin_samples_each_way));
  rest.cell_m = static_cast<double>(lattice.cell_size_m());
  rest.nodes = lattice.mesh().node_count();
  rest.centre_m = report.bodies[0].centre_of_mass_m;
  rest.nodes_mean_m = find_nodes_mean_m(lattice);
  rest.moved_m = rest.centre_m - from_m;
  rest.force_n = report.bodies[1].contact_force_n;
  rest.weight_n = lattice.mass_kg() * standard_gravity_m_per_s2;
  return rest;
}

}  // namespace spoonbill
