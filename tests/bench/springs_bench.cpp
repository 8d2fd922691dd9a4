// Times one step of a block of count^3 mass points with springs along edges, face diagonals and body
// diagonals. Our code also limits speeds and tracks the highest frequency, as in a tick. `springs_full` adds
// the volume force of each cell, damping, and plastic flow. Argument: nodes per side.
#include <benchmark/benchmark.h>

#include "engine/base/processor.h"
#include "engine/material/lattice_solver.h"
#include "engine/material/springs/spring_lattice.h"
#include "tests/bench/bullet_blocks.h"

namespace spoonbill {
namespace {

// Returns a material with a Poisson's ratio of 1/4, for which springs need no volume force.
Material springs_alone() {
  Material material;
  material.name = material.source = "benchmark";
  material.youngs_modulus_pa = 1e4;
  material.poissons_ratio = 0.25;
  material.density_kg_per_m3 = 1000.0;
  return material;
}

Material clay() {
  Material material = springs_alone();
  material.poissons_ratio = 0.45;
  material.damping_time_s = 1.1e-5;
  material.plastic = true;
  material.yield_strain = 0.005;
  material.flow_rate_per_s = 300.0;
  material.hardening = 0.1;
  return material;
}

SpringLattice block(int count, const Material& material) {
  const LatticeMesh mesh = box_mesh(Vector3::Constant(0.1), {count, count, count});
  SpringLattice lattice = SpringLattice::make(mesh, material, best_instruction_set()).value();
  std::vector<std::uint8_t> held(static_cast<std::size_t>(mesh.node_count()));
  for (int node = 0; node < count * count; ++node) held[static_cast<std::size_t>(node)] = 1;
  lattice.fix_nodes(held);
  return lattice;
}

// A tick of the bundled recording has this many substeps. The benchmark runs that many at once, without a
// tool.
constexpr int substeps_a_tick = 6;

void time_ours(benchmark::State& state, const Material& material) {
  const DenormalsFlushed flushed;
  SpringLattice lattice = block(static_cast<int>(state.range(0)), material);
  RelaxSettings settings;
  settings.substeps = substeps_a_tick;
  settings.time_s = substeps_a_tick * lattice.stable_step_s(0.5);
  while (state.KeepRunningBatch(substeps_a_tick)) {
    const int step = substeps_a_tick * static_cast<int>(settings.tick);
    const Vector3 gravity_m_per_s2(0.0, block_shaking_m_per_s2(step), 0.0);
    relax(std::array{RelaxedLattice{&lattice, gravity_m_per_s2}}, settings, {});
    ++settings.tick;
  }
  const int last = lattice.mesh().node_count() - 1;
  if (!(lattice.displacement(last).norm() < 0.1)) state.SkipWithError("the block flew apart");
}

void springs_ours(benchmark::State& state) {
  time_ours(state, springs_alone());
}

void springs_full(benchmark::State& state) {
  time_ours(state, clay());
}

void time_bullet(benchmark::State& state, BulletBlock& block) {
  const DenormalsFlushed flushed;
  while (state.KeepRunning()) block.step();
  if (!block.sane()) state.SkipWithError("Bullet's block flew apart");
  state.counters["springs"] = block.link_count();
}

void springs_position_based(benchmark::State& state) {
  time_bullet(state, *bullet_position_based_block(static_cast<int>(state.range(0))));
}

void springs_explicit(benchmark::State& state) {
  time_bullet(state, *bullet_explicit_block(static_cast<int>(state.range(0))));
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMicrosecond);
  for (const int count : {8, 12, 16, 24, 32}) bench->Arg(count);
}

// Adds sizes at which only our code is timed, because Bullet's position-based body diverges there.
void sizes_of_ours(benchmark::internal::Benchmark* bench) {
  sizes(bench);
  for (const int count : {48, 64}) bench->Arg(count);
}

BENCHMARK(springs_ours)->Apply(sizes_of_ours);
BENCHMARK(springs_full)->Apply(sizes_of_ours);
BENCHMARK(springs_position_based)->Apply(sizes);
BENCHMARK(springs_explicit)->Apply(sizes);

}  // namespace
}  // namespace spoonbill
