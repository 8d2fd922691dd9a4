// Tests bodies at rest under load against closed forms.
#include "engine/material/statics/static_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/material/block.h"
#include "tests/engine/material/statics/static_cases.h"

namespace spoonbill {
namespace {

struct Measured {
  double youngs_modulus_pa, poissons_ratio;
};

// Makes a virtual tension test: the far end is pulled out and free to slip. The necessary force gives Young's
// modulus, and the lateral contraction of the central part gives Poisson's ratio.
Measured tension_test(const StaticBody& body, const Vector3& size_m, int axis) {
  constexpr double strain = 1e-6;
  const LatticeMesh& mesh = body.mesh();
  std::vector<FixedAxis> held = slipping_base(mesh, axis);
  visit_face(mesh, axis, true, [&](int node, double) {
    held.push_back({node, axis, strain * size_m[axis]});
  });
  const StaticResult result = rest_of(body, {}, held);
  double force = 0.0;
  visit_face(mesh, axis, true,
             [&](int node, double) { force += result.reaction_n[static_cast<std::size_t>(node)][axis]; });
  double narrower = 0.0;
  for (const int across : {(axis + 1) % 3, (axis + 2) % 3}) {
    for (const bool high : {false, true}) {
      visit_face(mesh, across, high, [&](int node, double share) {
        const double moved = result.displacement_m[static_cast<std::size_t>(node)][across];
        narrower += 0.5 * share * (high ? -moved : moved) / size_m[across];
      });
    }
  }
  const double area = size_m[(axis + 1) % 3] * size_m[(axis + 2) % 3];
  return {force / (area * strain), narrower / strain};
}

struct Brick {
  Vector3 size_m;
  std::array<int, 3> counts;
};

// A bar under uniaxial tension has exactly the material's constants, with cubic cells and with cells of
// 1.2 : 1 : 1 and 1.5 : 1.5 : 1.
TEST(StaticSolver, TensionGivesTheMaterialExactly) {
  constexpr double youngs = 2e6;
  for (const Brick& brick : {Brick{{0.004, 0.003, 0.005}, {5, 4, 6}}, Brick{{0.006, 0.003, 0.004}, {6, 4, 5}},
                             Brick{{0.006, 0.0045, 0.002}, {5, 4, 3}}}) {
    for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
      for (const double poisson : {0.0, 0.1, 0.25, 0.35, 0.45, 0.49}) {
        if (kind == CellKind::springs && poisson < 0.25) continue;
        const StaticBody body =
            body_of(box_mesh(brick.size_m, brick.counts), elastic_material(youngs, poisson, 1000.0), kind);
        for (int axis = 0; axis < 3; ++axis) {
          const Measured measured = tension_test(body, brick.size_m, axis);
          // The bound allows for terms of second order at a strain of 1e-6.
          EXPECT_NEAR(measured.youngs_modulus_pa / youngs, 1.0, 1e-5) << poisson << ", axis " << axis;
          EXPECT_NEAR(measured.poissons_ratio, poisson, 1e-5) << poisson << ", axis " << axis;
        }
      }
    }
  }
}

// The bar has several cells across, at three resolutions.
TEST(StaticSolver, TensionOfABar) {
  constexpr double youngs = 2e6, poisson = 0.35;
  const Vector3 size_m(0.04, 0.008, 0.008);
  for (const int cells : {2, 3, 4}) {
    for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
      const LatticeMesh mesh = box_mesh(size_m, {5 * cells + 1, cells + 1, cells + 1});
      const Measured measured =
          tension_test(body_of(mesh, elastic_material(youngs, poisson, 1000.0), kind), size_m, 0);
      EXPECT_NEAR(measured.youngs_modulus_pa / youngs, 1.0, 1e-5) << cells;
      EXPECT_NEAR(measured.poissons_ratio, poisson, 1e-5) << cells;
      const std::string curve = kind == CellKind::springs ? "springs_" : "hexahedra_";
      const std::string count = curve + std::to_string(mesh.node_count());
      RecordProperty("bar_youngs_" + count, std::to_string(measured.youngs_modulus_pa / youngs));
      RecordProperty("bar_poisson_" + count, std::to_string(measured.poissons_ratio - poisson));
    }
  }
}

// The inner nodes are displaced at random: hexahedra pass the patch test in any shape, springs only
// approximately.
TEST(StaticSolver, TensionOfIrregularCells) {
  constexpr double youngs = 2e6;
  const Vector3 size_m(0.006, 0.006, 0.006);
  LatticeMesh mesh = box_mesh(size_m, {5, 5, 5});
  Random random(5);
  for (int i = 1; i < 4; ++i) {
    for (int j = 1; j < 4; ++j) {
      for (int k = 1; k < 4; ++k) {
        mesh.nodes[static_cast<std::size_t>(mesh.index(i, j, k))] +=
            2e-4 * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      }
    }
  }
  for (const double poisson : {0.25, 0.45}) {
    const Material material = elastic_material(youngs, poisson, 1000.0);
    const Measured hexahedra = tension_test(body_of(mesh, material, CellKind::hexahedra), size_m, 1);
    EXPECT_NEAR(hexahedra.youngs_modulus_pa / youngs, 1.0, 1e-5);
    EXPECT_NEAR(hexahedra.poissons_ratio, poisson, 1e-5);
    const Measured springs = tension_test(body_of(mesh, material, CellKind::springs), size_m, 1);
    EXPECT_NEAR(springs.youngs_modulus_pa / youngs, 1.0, 0.01);
    EXPECT_NEAR(springs.poissons_ratio, poisson, 0.01);
  }
}

// The top sinks by rho g H^2 / 2 E at any resolution and Poisson's ratio; gravity is a thousandth of the real
// one, to stay in the linear range.
TEST(StaticSolver, SelfWeightOnASlippingBase) {
  const double height = 0.02, youngs = 5000.0, density = 1050.0, gravity = 9.81e-3;
  const double expected = density * gravity * height * height / (2.0 * youngs);
  EXPECT_NEAR(1e3 * expected, 0.412e-3, 0.001e-3);
  for (const int count : {3, 5, 9}) {
    for (const double poisson : {0.25, 0.45, 0.49}) {
      for (const CellKind kind : {CellKind::springs, CellKind::hexahedra}) {
        const LatticeMesh mesh = box_mesh({height, height, height}, {count, count, count});
        const StaticBody body = body_of(mesh, elastic_material(youngs, poisson, density), kind);
        StaticLoads loads;
        loads.gravity_m_per_s2 = {0.0, -gravity, 0.0};
        const StaticResult result = rest_of(body, loads, slipping_base(mesh, 1));
        double drop = 0.0;
        visit_face(mesh, 1, true, [&](int node, double share) {
          drop -= share * result.displacement_m[static_cast<std::size_t>(node)].y();
        });
        // The bound allows for terms of second order at the base's strain of 4e-5.
        EXPECT_NEAR(drop / expected, 1.0, 1e-4) << count << " nodes, nu " << poisson;
      }
    }
  }
}

// Pressure from all sides reduces the volume by the fraction p / K, where K = E / 3 (1 - 2 nu).
TEST(StaticSolver, PressureFromAllSides) {
  const double youngs = 1e6, poisson = 0.4, pressure = 1.0;
  const LatticeMesh mesh = box_mesh({0.01, 0.01, 0.01}, {4, 4, 4});
  StaticLoads loads;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (const bool high : {false, true}) {
      for (int p = 0; p < 3; ++p) {
        for (int q = 0; q < 3; ++q) {
          PressedFace face{{}, pressure};
          const int corners[4][2] = {{p, q}, {p + 1, q}, {p + 1, q + 1}, {p, q + 1}};
          // On the low side p and q are exchanged, which reverses the order of the corners. All faces are
          // still visited, because p and q have the same range.
          for (std::size_t c = 0; c < 4; ++c) {
            std::array<int, 3> at{};
            at[axis] = high ? 3 : 0;
            at[a] = corners[c][high ? 0 : 1];
            at[b] = corners[c][high ? 1 : 0];
            face.nodes[c] = mesh.index(at[0], at[1], at[2]);
          }
          loads.pressures.push_back(face);
        }
      }
    }
  }
  const StaticBody body = body_of(mesh, elastic_material(youngs, poisson, 1000.0), CellKind::hexahedra);
  std::vector<FixedAxis> held;
  fix_node(mesh.index(0, 0, 0), Vector3::Zero(), held);
  held.push_back({mesh.index(3, 0, 0), 1, 0.0});
  held.push_back({mesh.index(3, 0, 0), 2, 0.0});
  held.push_back({mesh.index(0, 3, 0), 2, 0.0});
  const StaticResult result = rest_of(body, loads, held);
  const double shorter = pressure * (1.0 - 2.0 * poisson) / youngs;
  EXPECT_NEAR(-result.displacement_m[static_cast<std::size_t>(mesh.index(3, 3, 3))].y() / 0.01, shorter,
              1e-5 * shorter);
  Vector3 borne = Vector3::Zero();
  for (const Vector3& reaction : result.reaction_n) borne += reaction;
  EXPECT_LT(borne.norm(), 1e-10);
}

TEST(StaticSolver, SupportsBearTheWeight) {
  const LatticeMesh mesh = box_mesh({0.02, 0.03, 0.02}, {4, 5, 4});
  const StaticBody body = body_of(mesh, elastic_material(1e5, 0.3, 1000.0), CellKind::hexahedra);
  StaticLoads loads;
  loads.gravity_m_per_s2 = {1.0, -9.81, 2.0};
  std::vector<FixedAxis> held;
  visit_face(mesh, 1, false, [&](int node, double) { fix_node(node, Vector3::Zero(), held); });
  Vector3 borne = Vector3::Zero();
  for (const Vector3& reaction : rest_of(body, loads, held).reaction_n) borne += reaction;
  const double mass = 0.02 * 0.03 * 0.02 * 1000.0;
  EXPECT_LT((borne + mass * loads.gravity_m_per_s2).norm(), 1e-6 * mass * 9.81);
}

TEST(StaticSolver, RefusesWhatCannotRest) {
  const Result<StaticBody> springs = StaticBody::make(box_mesh({0.02, 0.02, 0.02}, {3, 3, 3}),
                                                      elastic_material(1e5, 0.2, 1000.0), CellKind::springs);
  ASSERT_FALSE(springs.ok());
  EXPECT_EQ(springs.error().code, ErrorCode::unsupported) << springs.error().message;
  EXPECT_EQ(springs.error().field, "poissons_ratio");
  const LatticeMesh mesh = box_mesh({0.02, 0.02, 0.02}, {3, 3, 3});
  const StaticBody body = body_of(mesh, elastic_material(1e5, 0.3, 1000.0), CellKind::hexahedra);
  const auto refusal = [&](const std::vector<FixedAxis>& held) {
    const Result<StaticResult> result = rest_under_load(body, {}, held);
    EXPECT_FALSE(result.ok());
    return result.ok() ? Error{ErrorCode::internal, "no refusal"} : result.error();
  };
  EXPECT_EQ(refusal({}).code, ErrorCode::too_few);
  EXPECT_EQ(refusal({}).field, "supports");
  std::vector<FixedAxis> in_line;
  for (const int i : {0, 1, 2}) fix_node(mesh.index(i, 0, 0), Vector3::Zero(), in_line);
  EXPECT_EQ(refusal(in_line).code, ErrorCode::too_few);
  EXPECT_EQ(refusal({{27, 0, 0.0}}).code, ErrorCode::unknown);
  EXPECT_EQ(refusal({{0, 3, 0.0}}).code, ErrorCode::unknown);
  EXPECT_EQ(refusal({{0, 0, std::nan("")}}).code, ErrorCode::out_of_range);
}

TEST(StaticSolver, NothingMovesWhereEverythingIsFixed) {
  const LatticeMesh mesh = box_mesh({0.02, 0.02, 0.02}, {3, 3, 3});
  const StaticBody body = body_of(mesh, elastic_material(1e5, 0.3, 1000.0), CellKind::hexahedra);
  StaticLoads loads;
  loads.gravity_m_per_s2 = {0.0, -9.81, 0.0};
  for (const Vector3& moved : {Vector3(0, 0, 0), Vector3(0, 0.001, 0)}) {
    std::vector<FixedAxis> held;
    for (int n = 0; n < mesh.node_count(); ++n) fix_node(n, moved, held);
    const Result<StaticResult> result = rest_under_load(body, loads, held);
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_TRUE(result->is_fixed_everywhere);
    Vector3 borne = Vector3::Zero();
    for (const Vector3& reaction : result->reaction_n) borne += reaction;
    EXPECT_NEAR(borne.y(), 0.02 * 0.02 * 0.02 * 1000.0 * 9.81, 1e-8);
    for (const Vector3& displacement : result->displacement_m) EXPECT_EQ(displacement, moved);
  }
}

TEST(StaticSolver, RefusesMoreWorkThanItsLimit) {
  StaticSettings settings;
  settings.work_limit = 2e6;
  const auto rest = [&](int along) {
    const LatticeMesh mesh = box_mesh({0.02, 0.02, 0.02}, {along, along, along});
    const StaticBody body = body_of(mesh, elastic_material(1e5, 0.3, 1000.0), CellKind::hexahedra);
    std::vector<FixedAxis> held;
    visit_face(mesh, 1, false, [&](int node, double) { fix_node(node, Vector3::Zero(), held); });
    return rest_under_load(body, {}, held, settings);
  };
  const Result<StaticResult> large = rest(8);
  ASSERT_FALSE(large.ok());
  EXPECT_EQ(large.error().code, ErrorCode::too_many) << large.error().message;
  EXPECT_EQ(large.error().field, "lattice");
  EXPECT_TRUE(rest(4).ok());
}

// Cancels the computation at different progress reports, from the first to one of the last. Some of the
// reports are made within one factorisation.
TEST(StaticSolver, StopsWithinAFactorisation) {
  const LatticeMesh mesh = box_mesh({0.02, 0.02, 0.02}, {10, 10, 10});
  const StaticBody body = body_of(mesh, elastic_material(1e5, 0.3, 1000.0), CellKind::hexahedra);
  StaticLoads loads;
  loads.gravity_m_per_s2 = {0.0, -9.81, 0.0};
  std::vector<FixedAxis> held;
  visit_face(mesh, 1, false, [&](int node, double) { fix_node(node, Vector3::Zero(), held); });
  const auto rest_with = [&](int report_limit, int& reports) {
    StaticSettings settings;
    settings.progress = Progress([&reports, report_limit](double) { return ++reports <= report_limit; });
    return rest_under_load(body, loads, held, settings);
  };
  int all = 0;
  const Result<StaticResult> whole = rest_with(std::numeric_limits<int>::max(), all);
  ASSERT_TRUE(whole.ok()) << whole.error().message;
  const int factors = whole->newton_steps + 1;
  EXPECT_GT(all, 5 * factors);
  for (int limit = 0; limit < all; limit += 1 + all / 10) {
    int reports = 0;
    const Result<StaticResult> stopped = rest_with(limit, reports);
    ASSERT_FALSE(stopped.ok()) << limit;
    EXPECT_EQ(stopped.error().code, ErrorCode::cancelled) << limit << ": " << stopped.error().message;
    EXPECT_EQ(reports, limit + 1);
  }
}

}  // namespace
}  // namespace spoonbill
