// jelly_bench SOLUTION [ROUNDS]: lets the block of jelly (jelly_block.h) sag under its own weight, as a trial
// and as Bullet's deformable body. Prints as JSON, for each, the time that the first simulated second takes
// on the thread's own clock, as the median of the rounds (default: 5), and the error of the state of rest
// against the solution by finite elements in the file SOLUTION (calculix/jelly.py).
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/processor.h"
#include "engine/exchange/json.h"
#include "engine/simulation/simulation.h"
#include "engine/trial/trial.h"
#include "tests/bench/bullet_jelly.h"
#include "tests/bench/jelly_block.h"

namespace spoonbill {
namespace {

// The blocks are released at rest, undeformed. Vibrations of Bullet's block decay faster, because drag or
// the implicit scheme damps them.
constexpr double timed_s = 1.0, rest_after_s = 4.0, bullet_rest_after_s = 2.0;

double thread_time_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Returns the surface of the block as a bilinear tube along x, with sharp edges. Its control points around
// and along are as dense as the nodes of the lattice.
Surface block_surface() {
  const int up = jelly_counts[1] - 1, across = jelly_counts[2] - 1, along = jelly_counts[0] - 1;
  std::vector<Vector3> ring;  // from the lower corner at +z, seen from +x against the clock
  const auto add = [&](double y, double z) {
    ring.emplace_back(0.0, jelly_size_m.y() * y, jelly_size_m.z() * (z - 0.5));
  };
  for (int k = 0; k < across; ++k) add(0.0, 1.0 - static_cast<double>(k) / across);
  for (int j = 0; j < up; ++j) add(static_cast<double>(j) / up, 0.0);
  for (int k = 0; k < across; ++k) add(1.0, static_cast<double>(k) / across);
  for (int j = 0; j < up; ++j) add(1.0 - static_cast<double>(j) / up, 1.0);
  // Columns: a pole, the rings along x, a pole.
  ControlNet net(static_cast<int>(ring.size()), along + 3);
  const Vector3 centre(0.0, 0.5 * jelly_size_m.y(), 0.0);
  for (int row = 0; row < net.rows; ++row) {
    for (int column = 0; column < net.columns; ++column) {
      const bool is_pole = column == 0 || column == net.columns - 1;
      const int at = std::clamp(column - 1, 0, along);
      const double x = jelly_size_m.x() * (static_cast<double>(at) / along - 0.5);
      net.set_point(row, column,
                    (is_pole ? centre : ring[static_cast<std::size_t>(row)]) + x * Vector3::UnitX());
    }
  }
  return make_surface(KnotVector::periodic_uniform(1, net.rows).value(),
                      KnotVector::clamped_uniform(1, net.columns).value(), net)
      .value();
}

Result<Simulation> make_ours() {
  Scene scene;
  Body jelly;
  jelly.name = "jelly";
  jelly.surface = block_surface();
  jelly.material = jelly_material();
  jelly.lattice.counts = jelly_counts;
  jelly.lattice.cells = LatticeCells::box;
  scene.bodies.push_back(jelly);
  // Fixes the base and no node above it.
  scene.planes.push_back({Vector3(0.0, 1e-4, 0.0), Vector3::UnitY()});
  auto trial = make_trial_scene(std::move(scene), {});
  if (!trial) return trial.error();
  return Simulation::make(std::move(trial).value(), best_instruction_set());
}

std::vector<Vector3> displacements_m(const SpringLattice& lattice) {
  std::vector<Vector3> moved(static_cast<std::size_t>(lattice.mesh().node_count()));
  for (int node = 0; node < lattice.mesh().node_count(); ++node) {
    const auto [i, j, k] = lattice.mesh().grid_index(node);
    moved[static_cast<std::size_t>(jelly_node_index(i, j, k))] = lattice.displacement(node);
  }
  return moved;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Json describe(const std::vector<double>& times_s, const std::vector<Vector3>& rest_m, double fastest_m_per_s,
              std::span<const Vector3> solution_m) {
  return {{"s_per_s", median(times_s) / timed_s},
          {"error", relative_jelly_error(rest_m, solution_m)},
          {"sag_mm", 1e3 * jelly_sag_m(rest_m)},
          {"speed_at_rest_mm_per_s", 1e3 * fastest_m_per_s}};
}

Result<Json> measure_ours(int rounds, std::span<const Vector3> solution_m) {
  std::vector<double> times_s;
  std::optional<Simulation> simulation;
  for (int round = 0; round < rounds; ++round) {
    auto made = make_ours();
    if (!made) return made.error();
    simulation.emplace(std::move(made).value());
    const double start_s = thread_time_s();
    for (int tick = 0; tick < std::lround(timed_s / tick_s); ++tick) simulation->advance(trial_input());
    times_s.push_back(thread_time_s() - start_s);
  }
  for (int tick = 0; tick < std::lround((rest_after_s - timed_s) / tick_s); ++tick) {
    simulation->advance(trial_input());
  }
  const SpringLattice& lattice = simulation->lattice();
  Json all = describe(times_s, displacements_m(lattice), lattice.fastest_m_per_s(), solution_m);
  all["step_s"] = tick_s / simulation->substeps();
  all["poissons_ratio"] = jelly_material().poissons_ratio;
  all["nodes"] = lattice.mesh().node_count();
  all["fixed_nodes"] = lattice.fixed_count();
  return all;
}

int count_steps(double seconds, double step_s) {
  return static_cast<int>(std::lround(seconds / step_s));
}

double largest_m(const std::vector<Vector3>& displacements_m) {
  double largest = 0.0;
  for (const Vector3& displacement : displacements_m) largest = std::max(largest, displacement.norm());
  return largest;
}

// Returns whether Bullet's block is at rest, and never far from its start, after a second. An unstable block
// moves at metres per second; Bullet bounds its speed and turns NaN into 0.
bool is_stable(const BulletJellySettings& settings) {
  constexpr double still_m_per_s = 1e-3, near_m = 1e-3;
  constexpr int steps_between_checks = 20;
  const std::unique_ptr<BulletJelly> jelly = make_bullet_jelly(settings);
  for (int step = 0; step < count_steps(timed_s, settings.step_s); ++step) {
    jelly->step();
    if (step % steps_between_checks == 0 && !(largest_m(jelly->displacements_m()) < near_m)) return false;
  }
  return jelly->largest_speed_m_per_s() < still_m_per_s;
}

// Returns the settings with the largest stable step, to within 2 %.
BulletJellySettings with_largest_step(BulletJellySettings settings) {
  double stable_s = 1e-4, unstable_s = 8e-4;
  while (unstable_s > 1.02 * stable_s) {
    settings.step_s = std::sqrt(stable_s * unstable_s);
    (is_stable(settings) ? stable_s : unstable_s) = settings.step_s;
  }
  settings.step_s = stable_s;
  return settings;
}

Json measure_bullet(const BulletJellySettings& settings, int rounds, std::span<const Vector3> solution_m) {
  std::vector<double> times_s;
  std::unique_ptr<BulletJelly> jelly;
  for (int round = 0; round < rounds; ++round) {
    jelly = make_bullet_jelly(settings);
    const double start_s = thread_time_s();
    for (int step = 0; step < count_steps(timed_s, settings.step_s); ++step) jelly->step();
    times_s.push_back(thread_time_s() - start_s);
  }
  for (int step = 0; step < count_steps(bullet_rest_after_s - timed_s, settings.step_s); ++step)
    jelly->step();
  Json all = describe(times_s, jelly->displacements_m(), jelly->largest_speed_m_per_s(), solution_m);
  all["step_s"] = settings.step_s;
  all["poissons_ratio"] = settings.poissons_ratio;
  return all;
}

int run(const std::string& file, int rounds) {
  const auto solution = read_jelly_solution_m(file);
  if (!solution) {
    std::cerr << solution.error().message << '\n';
    return 1;
  }
  const auto ours = measure_ours(rounds, solution.value());
  if (!ours) {
    std::cerr << ours.error().message << '\n';
    return 1;
  }
  // The drag damps the slowest vibration, of 20 Hz, almost critically.
  constexpr double drag_per_s = 200.0;
  // Tetrahedra of a nearly incompressible material lock: with this Poisson's ratio, although it is not the
  // jelly's, Bullet's error is about the smallest.
  constexpr double loose_poissons_ratio = 0.46;
  const std::array<std::pair<const char*, BulletJellySettings>, 4> peers{{
      {"explicit", with_largest_step({.drag_per_s = drag_per_s})},
      {"explicit, looser",
       with_largest_step({.poissons_ratio = loose_poissons_ratio, .drag_per_s = drag_per_s})},
      {"implicit, 1/240 s", {.is_implicit = true, .step_s = 1.0 / 240.0}},
      {"implicit, 1/60 s", {.is_implicit = true, .step_s = 1.0 / 60.0}},
  }};
  Json bullet = Json::object();
  for (const auto& [name, settings] : peers) {
    bullet[name] = measure_bullet(settings, rounds, solution.value());
  }
  std::cout << Json{{"solution_sag_mm", 1e3 * jelly_sag_m(solution.value())},
                    {"ours", ours.value()},
                    {"bullet", bullet}}
                   .dump()
            << '\n';
  return 0;
}

}  // namespace
}  // namespace spoonbill

int main(int count, char** arguments) {
  if (count < 2) {
    std::cerr << "usage: jelly_bench SOLUTION [ROUNDS]\n";
    return 2;
  }
  const std::span<char*> all(arguments, static_cast<std::size_t>(count));
  const spoonbill::DenormalsFlushed flushed;
  return spoonbill::run(all[1], count > 2 ? std::max(1, std::atoi(all[2])) : 5);
}
