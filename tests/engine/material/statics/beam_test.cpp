// Tests cantilevers at rest under load against beam theory.
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <string>

#include "engine/material/lattice/lattice_mesh.h"
#include "tests/engine/material/block.h"
#include "tests/engine/material/statics/static_cases.h"

namespace spoonbill {
namespace {

struct Beam {
  Vector3 size_m;
  std::array<int, 3> counts;
  double force_n;  // force at the far end along x, in the direction -z
};

// Returns the mean deflection of the far end of a cantilever whose near end is fixed in all directions.
double sinking_m(const Beam& beam, const Material& material, CellKind kind) {
  const LatticeMesh mesh = box_mesh(beam.size_m, beam.counts);
  std::vector<FixedAxis> held;
  visit_face(mesh, 0, false, [&](int node, double) { fix_node(node, Vector3::Zero(), held); });
  StaticLoads loads;
  visit_face(mesh, 0, true, [&](int node, double share) {
    loads.forces.push_back({node, {0.0, 0.0, -share * beam.force_n}});
  });
  const StaticResult result = rest_of(body_of(mesh, material, kind), loads, held);
  double sum = 0.0;
  visit_face(mesh, 0, true, [&](int node, double share) {
    sum -= share * result.displacement_m[static_cast<std::size_t>(node)].z();
  });
  return sum;
}

double euler_bernoulli_m(const Beam& beam, double youngs_modulus_pa) {
  const double second_moment = beam.size_m.y() * std::pow(beam.size_m.z(), 3) / 12.0;
  return beam.force_n * std::pow(beam.size_m.x(), 3) / (3.0 * youngs_modulus_pa * second_moment);
}

// Returns a cube's springs without body diagonals: k = 2 E a / 5 for each edge, which four cells share, and
// for each face diagonal, which two cells share.
CellSprings cube_without_body_diagonals(double edge_m, double youngs_modulus_pa) {
  CellSprings springs;
  springs.volume_m3 = edge_m * edge_m * edge_m;
  for (std::size_t s = 0; s < 12; ++s) springs.stiffness_n_per_m[s] = 0.1 * youngs_modulus_pa * edge_m;
  for (std::size_t s = 12; s < 24; ++s) springs.stiffness_n_per_m[s] = 0.2 * youngs_modulus_pa * edge_m;
  return springs;
}

// Returns the deflection, as sinking_m() does, but to first order and for a beam whose cells all have this
// stiffness.
double linear_sinking_m(const Beam& beam, const CellMatrix& stiffness) {
  const LatticeMesh mesh = box_mesh(beam.size_m, beam.counts);
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(mesh.node_count());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        const auto row = [&](int a) {
          return 3 * mesh.index(i + (a / 3 >> 2 & 1), j + (a / 3 >> 1 & 1), k + (a / 3 & 1)) + a % 3;
        };
        for (int a = 0; a < 24; ++a) {
          for (int b = 0; b < 24; ++b) entries.emplace_back(row(a), row(b), stiffness(a, b));
        }
      }
    }
  }
  visit_face(mesh, 0, false, [&](int node, double) {
    for (int a = 0; a < 3; ++a) entries.emplace_back(3 * node + a, 3 * node + a, 1e6 * stiffness.trace());
  });
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd load = Eigen::VectorXd::Zero(size);
  visit_face(mesh, 0, true, [&](int node, double share) { load[3 * node + 2] = share * beam.force_n; });
  const Eigen::VectorXd moved = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(load);
  double sum = 0.0;
  visit_face(mesh, 0, true, [&](int node, double share) { sum += share * moved[3 * node + 2]; });
  return sum;
}

// Ratio of the deflection with shear to the deflection by Euler and Bernoulli: 1 + 0.75 (h / L)^2 at nu =
// 1/4, for a beam whose length L is ten times its height h.
constexpr double timoshenko_ratio = 1.0075;

// Springs need many cells through the thickness; hexahedra need one. The beam is ten times as long as high,
// with a square cross section, cubic cells and nu = 1/4. The published ratios to Euler and Bernoulli are for
// springs without body diagonals. This lattice has body diagonals, which keep cells from folding and make it
// slightly stiffer.
TEST(Beam, CellsNearABeamWithTheirNumber) {
  const double published[] = {0.544, 0.812, 0.905, 0.944};
  for (int cells = 1; cells <= 4; ++cells) {
    const Beam beam{{0.1, 0.01, 0.01}, {10 * cells + 1, cells + 1, cells + 1}, 1e-3};
    const CellCorners cube = box_mesh(beam.size_m, beam.counts).cell(0, 0, 0);
    const double exact = euler_bernoulli_m(beam, 1e9);
    const SpringCell plain(cube, cube_without_body_diagonals(0.01 / cells, 1e9), 0.0, 1.0);
    CellMoves none;
    none.fill(Vector3::Zero());
    const CellMatrix stiffness = plain.respond(none, Tangent::plain).tangent;
    // The bound allows for the three published digits and for Poisson's ratio, which acts at the far end but
    // not at the fixed end.
    EXPECT_NEAR(linear_sinking_m(beam, stiffness) / exact, published[cells - 1], 0.002) << cells;
    const double ours = sinking_m(beam, elastic_material(1e9, 0.25, 1000.0), CellKind::springs) / exact;
    EXPECT_LT(ours, published[cells - 1]);
    EXPECT_GT(ours, published[cells - 1] - 0.09 / cells) << cells;
    RecordProperty("beam_springs_" + std::to_string(cells), std::to_string(ours / timoshenko_ratio));
    const double bending = sinking_m(beam, elastic_material(1e9, 0.25, 1000.0), CellKind::hexahedra) / exact;
    EXPECT_NEAR(bending / timoshenko_ratio, 1.0, 0.025) << cells << " hexahedra";
    RecordProperty("beam_hexahedra_" + std::to_string(cells), std::to_string(bending / timoshenko_ratio));
  }
}

struct Stiff {
  const char* name;
  // `sinking_m` is the deflection of the spoon-like beam according to Timoshenko's theory.
  double youngs_modulus_pa, poissons_ratio, sinking_m;
};

// The beam measures 100 x 12 x 3 mm, carries 0.2 N and is within the default budget of nodes; it is tested in
// four materials.
TEST(Beam, SpoonLikeBeamsSinkAsTimoshenkoSays) {
  const Beam beam{{0.1, 0.012, 0.003}, {51, 7, 3}, 0.2};
  EXPECT_LE(beam.counts[0] * beam.counts[1] * beam.counts[2], LatticeRequest{}.node_budget);
  for (const Stiff& stiff :
       {Stiff{"steel", 193e9, 0.29, 0.01279e-3}, Stiff{"beech", 11.9e9, 0.3, 0.2075e-3},
        Stiff{"abs", 2.0e9, 0.35, 1.235e-3}, Stiff{"polypropylene", 1.5e9, 0.42, 1.646e-3}}) {
    const double sinking = sinking_m(
        beam, elastic_material(stiff.youngs_modulus_pa, stiff.poissons_ratio, 1000.0), CellKind::hexahedra);
    EXPECT_NEAR(sinking / stiff.sinking_m, 1.0, 0.025) << stiff.name;
  }
}

// Returns the deflection of the tip of a cantilever of length 1 under a large force P that keeps its
// direction, where load = P L^2 / E I. Solves E I t'' = -P cos(t) for the slope t along the arc, with
// t(0) = 0 and t'(L) = 0, by shooting with the curvature at the root.
double elastica_sinking(double load) {
  const auto march = [&](double curvature) {
    constexpr int steps = 4000;
    double slope = 0.0, sinking = 0.0, bend = curvature;
    for (int s = 0; s < steps; ++s) {
      const double h = 1.0 / steps;
      const double half_bend = bend - 0.5 * h * load * std::cos(slope);
      const double middle = slope + 0.5 * h * half_bend;
      slope += h * half_bend;
      bend = half_bend - 0.5 * h * load * std::cos(slope);
      sinking += h * std::sin(middle);
    }
    return std::array{bend, sinking};
  };
  double low = 0.0, high = load + 1.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (march(middle)[0] < 0.0 ? low : high) = middle;
  }
  return march(low)[1];
}

TEST(Beam, SiliconeBendsAsAnElastica) {
  // A load P L^2 / E I of 1 makes the tip sink by 0.3017 L, and of 2 by 0.4935 L (Bisshopp and Drucker 1945).
  EXPECT_NEAR(elastica_sinking(1.0), 0.3017, 1e-4);
  EXPECT_NEAR(elastica_sinking(2.0), 0.4935, 1e-4);
  const double youngs = 5e6, bending = youngs * 0.012 * std::pow(0.003, 3) / 12.0;
  for (const double load : {0.1, 1.0, 5.0}) {
    const Beam beam{{0.1, 0.012, 0.003}, {51, 7, 2}, load * bending / 0.01};
    const double sinking = sinking_m(beam, elastic_material(youngs, 0.45, 1150.0), CellKind::hexahedra);
    EXPECT_NEAR(sinking / (0.1 * elastica_sinking(load)), 1.0, 0.05) << load;
  }
}

}  // namespace
}  // namespace spoonbill
