// A virtual tension test of the bundled handle measures the elastic constants of its lattice where the handle
// is a straight bar.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "engine/exchange/document.h"
#include "engine/material/lattice/body_lattice.h"
#include "engine/material/statics/static_solver.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

constexpr double strain = 1e-5;

// Returns the central half of the handle's lattice, which is straight along x and whose slices are plane.
LatticeMesh middle_half(const LatticeMesh& whole) {
  const int last = whole.count[2] - 1, first_slice = last / 4, last_slice = last - last / 4;
  LatticeMesh part;
  part.count = {whole.count[0], whole.count[1], last_slice - first_slice + 1};
  part.nodes.assign(whole.nodes.begin() + whole.index(0, 0, first_slice),
                    whole.nodes.begin() + whole.index(0, 0, last_slice + 1));
  return part;
}

double layer_volume_m3(const LatticeMesh& mesh, int k) {
  double volume = 0.0;
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) volume += cell_volume(mesh.cell(i, j, k));
  }
  return volume;
}

double slice_x_m(const LatticeMesh& mesh, int k) {
  return mesh.nodes[static_cast<std::size_t>(mesh.index(0, 0, k))].x();
}

// Fixes both ends along x, with the far end displaced to stretch the bar. Both ends may slide perpendicular
// to x.
std::vector<FixedAxis> drawn_ends(const LatticeMesh& mesh) {
  std::vector<FixedAxis> held;
  const int last = mesh.count[2] - 1;
  const double stretch_m = strain * (slice_x_m(mesh, last) - slice_x_m(mesh, 0));
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) {
      held.push_back({mesh.index(i, j, 0), 0, 0.0});
      held.push_back({mesh.index(i, j, last), 0, stretch_m});
    }
  }
  held.push_back({mesh.index(0, 0, 0), 1, 0.0});
  held.push_back({mesh.index(0, 0, 0), 2, 0.0});
  held.push_back({mesh.index(mesh.count[0] - 1, 0, 0), 1, 0.0});
  return held;
}

struct Measured {
  double youngs_modulus_pa, poissons_ratio;
};

// Measures a bar whose cross section changes along it. A force F strains a layer of length l and area A by
// F / (E A), so F / E = stretch / sum (l / A) over all layers. The volume of a layer grows by the fraction
// (1 - 2 nu) F / (E A).
Measured tension_test(const LatticeMesh& mesh, const StaticBody& body) {
  const Result<StaticResult> found = rest_under_load(body, {}, drawn_ends(mesh));
  EXPECT_TRUE(found.ok()) << found.error().message;
  const StaticResult& result = found.value();
  const int last = mesh.count[2] - 1;
  double force_n = 0.0;
  for (int n = mesh.index(0, 0, last); n < mesh.node_count(); ++n) {
    force_n += result.reaction_n[static_cast<std::size_t>(n)].x();
  }
  LatticeMesh drawn = mesh;
  for (std::size_t n = 0; n < drawn.nodes.size(); ++n) drawn.nodes[n] += result.displacement_m[n];
  double lengths_by_area = 0.0, larger = 0.0;
  for (int k = 0; k < last; ++k) {
    const double length = slice_x_m(mesh, k + 1) - slice_x_m(mesh, k), volume = layer_volume_m3(mesh, k);
    lengths_by_area += length * length / volume;
    larger += layer_volume_m3(drawn, k) - volume;
  }
  const double whole_length = slice_x_m(mesh, last) - slice_x_m(mesh, 0);
  const double force_by_youngs = strain * whole_length / lengths_by_area;
  return {force_n / force_by_youngs, 0.5 * (1.0 - larger / (force_by_youngs * whole_length))};
}

TEST(HandleElasticity, IsTheMaterialsAtAnyResolution) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  const auto document =
      read_document(std::filesystem::path(SPOONBILL_ASSETS) / "models" / "spoon-handle.json");
  ASSERT_TRUE(document.ok());
  const Body& handle = document->scene.bodies[0];
  for (const int budget : {500, 1000, 2000, 4000, 8000}) {
    if (budget > 4000 && !is_full_run()) continue;
    const Result<LatticeMesh> whole = tube_lattice(handle.surface, {budget, {}});
    ASSERT_TRUE(whole.ok());
    const LatticeMesh mesh = middle_half(whole.value());
    for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
      const Result<StaticBody> body = StaticBody::make(mesh, handle.material, kind);
      ASSERT_TRUE(body.ok());
      const Measured measured = tension_test(mesh, body.value());
      const double ratio = measured.youngs_modulus_pa / handle.material.youngs_modulus_pa;
      const bool springs = kind == CellKind::springs;
      const std::string count = (springs ? "springs_" : "hexahedra_") + std::to_string(whole->node_count());
      RecordProperty("handle_youngs_" + count, std::to_string(ratio));
      RecordProperty("handle_poisson_" + count,
                     std::to_string(measured.poissons_ratio - handle.material.poissons_ratio));
      // With fewer than 2000 nodes the cells are too slender for springs.
      if (springs && budget < 2000) continue;
      EXPECT_NEAR(ratio, 1.0, 0.03) << budget;
      EXPECT_NEAR(measured.poissons_ratio, handle.material.poissons_ratio, 0.02) << budget;
    }
  }
}

}  // namespace
}  // namespace spoonbill
