// Performs the recordings with local strokes on the bundled handle, and random strokes that refine the
// surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <random>
#include <vector>

#include "app/session/lockstep.h"
#include "engine/bspline/evaluate.h"
#include "engine/exchange/document.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/simulation/body_mapping.h"
#include "haptic/script.h"
#include "haptic/virtual_device.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

const std::filesystem::path recordings = SPOONBILL_ASSETS "/recordings";

constexpr std::array<double, 4> grips_m = {0.023, 0.041, 0.059, 0.077};

// Runs a script as `spoonbill record` does, and returns the session at its end.
Session perform(const std::string& name) {
  const Script script = read_script(recordings / (name + ".script.json")).value();
  const Document document = read_document(script.model_file).value();
  ScriptedDevice device = ScriptedDevice::make(script).value();
  Session session = Session::make(document, name, device.specification(), best_instruction_set()).value();
  session.reading = DeviceReading::from(script.start.pose, 0);
  LockstepInput input;
  input.device = &device;
  input.tick_count = script.tick_count();
  input.commands = script.commands;
  input.source = name;
  input.refines = true;
  Lockstep lockstep(session, std::move(input), nullptr);
  const Status finished = lockstep.finish();
  EXPECT_TRUE(finished) << finished.error().message;
  return session;
}

// Shape of four grips on the top of the handle, m.
struct Grips {
  std::array<double, 4> outward_m{};       // at the grips, negative for dents
  double highest_m = 0.0, lowest_m = 0.0;  // on the top
  double far_side_m = 0.0, between_m = 0.0, axis_m = 0.0;
};

Grips measure(const Surface& rest, const Surface& shaped) {
  Grips grips;
  constexpr int around = 96, along = 400;
  for (int b = 0; b <= along; ++b) {
    const double v = rest.v.domain_start() + rest.v.domain_length() * b / along;
    Vector3 centre = Vector3::Zero(), moved_centre = Vector3::Zero();
    double largest_m = 0.0;
    for (int a = 0; a < around; ++a) {
      const double u = rest.u.domain_start() + rest.u.domain_length() * a / around;
      const Vector3 start_m = evaluate(rest, u, v).position_m, normal = unit_normal(rest, u, v);
      const Vector3 move_m = evaluate(shaped, u, v).position_m - start_m;
      centre += start_m / around;
      moved_centre += (start_m + move_m) / around;
      largest_m = std::max(largest_m, move_m.norm());
      if (normal.y() < -0.5) grips.far_side_m = std::max(grips.far_side_m, move_m.norm());
      if (normal.y() < 0.5) continue;
      const double outward_m = move_m.dot(normal);
      grips.highest_m = std::max(grips.highest_m, outward_m);
      grips.lowest_m = std::min(grips.lowest_m, outward_m);
      for (std::size_t g = 0; g < grips_m.size(); ++g) {
        const bool is_there = std::abs(start_m.x() - grips_m[g]) < 1e-3 && std::abs(start_m.z()) < 1e-3;
        if (is_there && std::abs(outward_m) > std::abs(grips.outward_m[g])) grips.outward_m[g] = outward_m;
      }
    }
    const double x_m = centre.x();
    for (std::size_t g = 0; g + 1 < grips_m.size(); ++g) {
      if (std::abs(x_m - 0.5 * (grips_m[g] + grips_m[g + 1])) < 5e-4)
        grips.between_m = std::max(grips.between_m, largest_m);
    }
    if (x_m < grips_m.front() - 0.011 || x_m > grips_m.back() + 0.011)
      grips.axis_m = std::max(grips.axis_m, (moved_centre - centre).norm());
  }
  return grips;
}

// A quarter of a millimetre is far below the grips and what a finger tells apart.
constexpr double aside_m = 3e-4;

void expect_only_grips(const Grips& grips) {
  EXPECT_LT(grips.far_side_m, aside_m);
  EXPECT_LT(grips.between_m, aside_m);
  EXPECT_LT(grips.axis_m, aside_m);
}

// Four finger ridges as in Fig. 8 of Pungotra et al. (2013), without a fixing plane and with the settings of
// the bundled handle.
TEST(Grips, BulgeWhereTheHandPulls) {
  const Session session = perform("grip-bulge");
  const Surface rest = read_document(SPOONBILL_ASSETS "/models/spoon-handle.json")->scene.bodies[0].surface;
  const Grips grips = measure(rest, session.simulation.surface());
  for (const double outward_m : grips.outward_m) {
    EXPECT_GT(outward_m, 0.8 * 0.002);
    EXPECT_LT(outward_m, 1.2 * 0.002);
  }
  EXPECT_GT(grips.lowest_m, -aside_m) << "no moat";
  expect_only_grips(grips);
}

TEST(Grips, DentWhereTheHandPresses) {
  const Session session = perform("grip-dent");
  const Surface rest = read_document(SPOONBILL_ASSETS "/models/spoon-handle.json")->scene.bodies[0].surface;
  const Grips grips = measure(rest, session.simulation.surface());
  for (const double outward_m : grips.outward_m) {
    EXPECT_LT(outward_m, -0.8 * 0.0015);
    EXPECT_GT(outward_m, -1.2 * 0.0015);
  }
  EXPECT_LT(grips.highest_m, aside_m) << "no rim";
  expect_only_grips(grips);
}

// Random strokes of every kind on the bundled handle.
struct RandomStrokes {
  std::vector<DeviceReading> readings;
  std::vector<TimedCommand> commands;
  std::vector<std::uint64_t> rests;  // ticks at which the body has rested after a stroke

  explicit RandomStrokes(std::uint64_t ticks) {
    std::mt19937 random(7);
    const auto between = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() % 10000) / 1e4;
    };
    Vector3 at(0.05, 0.03, 0.0);
    const auto move = [&](const Vector3& to, int count, std::uint32_t buttons) {
      for (int t = 1; t <= count; ++t) {
        Pose pose;
        pose.position_m = at + (to - at) * (static_cast<double>(t) / count);
        readings.push_back(DeviceReading::from(pose, buttons));
      }
      at = to;
    };
    while (readings.size() < ticks) {
      Tool tool;
      tool.action = random() % 2 == 0 ? ToolAction::push : ToolAction::pull;
      tool.reach = random() % 3 == 0 ? ToolReach::whole : ToolReach::local;
      tool.radius_m = between(0.003, 0.008);
      commands.push_back({readings.size(), command_to_json(SetTool{tool}), "random strokes"});
      const double side = random() % 2 == 0 ? 1.0 : -1.0, x_m = between(0.01, 0.09),
                   z_m = between(-0.003, 0.003);
      const double depth_m = between(0.0005, 0.002);
      const bool pulls = tool.action == ToolAction::pull;
      const auto height = [&](double from_top_m) { return Vector3(x_m, side * (0.0025 + from_top_m), z_m); };
      move(Vector3(x_m, side * 0.03, z_m), 40, 0);
      move(height(pulls ? 0.3 * tool.radius_m : tool.radius_m), 60, 0);
      move(height(pulls ? 0.3 * tool.radius_m + depth_m : tool.radius_m - depth_m), 200, button_main);
      move(at, 150, button_main);
      move(Vector3(x_m, side * 0.03, z_m), 50, 0);
      move(at, 1100, 0);
      rests.push_back(readings.size() - 1);  // before the next tool
    }
  }
};

void expect_no_fold(const Simulation& simulation) {
  const SpringLattice& lattice = simulation.lattice();
  const LatticeMesh& mesh = lattice.mesh();
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        CellCorners corners;
        for (int c = 0; c < 8; ++c) {
          corners[static_cast<std::size_t>(c)] =
              lattice.position(mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1)));
        }
        ASSERT_GT(cell_volume(corners), 0.0) << i << ' ' << j << ' ' << k;
      }
    }
  }
}

TEST(RandomStrokes, KeepTheSurfaceWithTheLatticeAndUndo) {
  const RandomStrokes strokes(is_full_run() ? 120'000 : 10'000);
  const Document document = read_document(SPOONBILL_ASSETS "/models/spoon-handle.json").value();
  PlaybackDevice device(VirtualDevice::default_specification(), strokes.readings);
  Session session = Session::make(document, "handle", device.specification(), best_instruction_set()).value();
  session.reading = strokes.readings.front();
  const std::uint64_t start = shape_hash(session.simulation);
  LockstepInput input;
  input.device = &device;
  input.tick_count = strokes.readings.size();
  input.commands = strokes.commands;
  input.refines = true;
  Lockstep lockstep(session, std::move(input), nullptr);
  const double cell_m = static_cast<double>(session.simulation.lattice().cell_size_m());
  for (const std::uint64_t rest : strokes.rests) {
    const Status ran = lockstep.run_to(rest);
    ASSERT_TRUE(ran) << ran.error().message;
    Snapshot snapshot;
    write_snapshot(session, snapshot);
    const ResidualSnapshot& residual = snapshot.bodies[0].residual;
    const double radius_m = session.simulation.scene().tool.radius_m;
    const double tolerance_m = std::max({5e-5, 0.05 * radius_m, 0.1 * cell_m});
    EXPECT_TRUE(residual.largest_m <= tolerance_m || residual.is_at_limit)
        << residual.largest_m << " m, more than " << tolerance_m << " m, at tick " << rest;
    expect_no_fold(session.simulation);
  }
  const std::uint64_t end = shape_hash(session.simulation);
  while (session.history.can_undo()) ASSERT_TRUE(apply_request(session, UndoStroke{}));
  EXPECT_EQ(shape_hash(session.simulation), start);
  while (session.history.can_redo()) ASSERT_TRUE(apply_request(session, RedoStroke{}));
  EXPECT_EQ(shape_hash(session.simulation), end);
}

}  // namespace
}  // namespace spoonbill
