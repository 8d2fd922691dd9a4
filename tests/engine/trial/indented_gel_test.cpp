// Tests the force on a sphere (Hertz) and on a flat punch (Bloom) pressed into a round block, against
// axisymmetric finite elements of the same block.
//
// The forces are those of CalculiX 2.20, of a neo-Hookean block at finite strain. They are proportional to
// Young's modulus and are stated for 5 kPa. calculix/make_indented_gel_decks.py writes the decks; their
// forces are in calculix/indented_gel_results.csv.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "engine/shapes/fit_shape.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

constexpr double oracle_modulus_pa = 5000.0, height_m = 0.02;
constexpr double punch_radius_m = 0.00635, bloom_radius_m = 0.015;
constexpr double sphere_radius_m = 0.01, hertz_radius_m = 0.02;
constexpr double bonding_friction = 2.0;  // friction that holds the gel under the punch
constexpr double start_m = 1e-5;          // gap at the start, so that the bodies do not begin in each other

struct Depth {
  double depth_m = 0.0, oracle_n = 0.0;
  double tolerance = 0.0;  // relative; 0: the force is only printed
};

// A sphere at a Poisson's ratio of 0.45 and 0.49, with cells of 0.3 mm at the contact. Cells of 0.15 mm
// change the forces by less than 0.2 %. The depths of 0.5 and 1 mm are asserted, where the radius of the
// contact is at most a third of the sphere's, as Hertz's theory demands. The force at 2 mm is only printed,
// because a lattice of springs at large strain is a few per cent softer than a neo-Hookean body.
const std::vector<Depth> hertz_45 = {{0.5e-3, 0.010246, 0.05}, {1e-3, 0.030080, 0.05}, {2e-3, 0.089635}};
const std::vector<Depth> hertz_49 = {{0.5e-3, 0.010685, 0.05}, {1e-3, 0.031229, 0.05}, {2e-3, 0.092504}};
// A flat punch that the gel sticks to, with a sharp edge and cells of 0.2 mm there. Cells of 0.1 mm lower
// the force at 0.5 mm by 0.5 %. The force at 4 mm depends on the cells at the edge: cells of 0.4 mm raise
// it by 3.7 %.
const std::vector<Depth> bloom_bonded = {{0.5e-3, 0.049956, 0.05}, {4e-3, 0.41367, 0.10}};
// A flat punch without friction. At 0.5 mm its edge is rounded by 0.1 mm, as the edge of the body is; cells
// of 0.15 and 0.2 mm agree within 0.1 %. At 4 mm it is rounded by 0.4 mm; cells of 0.3 and 0.4 mm agree
// within 0.1 %, and with cells of 0.2 mm CalculiX does not get there. The force at 4 mm is uncertain by
// 5 %: another axisymmetric solver, which was written for this comparison alone and agrees with CalculiX
// within 0.1 % at 0.5 mm, gives 0.3676 N with cells of the same size.
const std::vector<Depth> bloom_slipping = {{0.5e-3, 0.048627, 0.05}, {4e-3, 0.38521, 0.10}};

enum class Indenter { sphere, bonded_punch, slipping_punch };

struct Indentation {
  const char* name = "";
  Indenter indenter = Indenter::sphere;
  double youngs_modulus_pa = 0.0, poissons_ratio = 0.0;
  int cells_high = 0;  // cells along the height of the block; they are cubes, but for rounding
  std::vector<Depth> depths = {};
  ForceRun run = ForceRun::whole_table;
};

void PrintTo(const Indentation& indentation, std::ostream* out) {
  *out << indentation.name;
}

// A surface whose samples are closer together than the lattice's nodes, so that contacts follow the cells.
Surface fine_surface(const StockShapeSize& size, const Vector3& centre_m, std::array<int, 2> controls) {
  ShapeFit fit;
  fit.control_counts = controls;
  return placed(fit_shape(stock_shape(size).value(), fit).value().surface,
                {centre_m, Quaternion::Identity()});
}

Body round_block(const Indentation& indentation) {
  const bool is_sphere = indentation.indenter == Indenter::sphere;
  const double radius_m = is_sphere ? hertz_radius_m : bloom_radius_m;
  Body block;
  block.name = "gel";
  block.surface = fine_surface(CylinderSize{radius_m, height_m, 0.001}, {0.0, 0.5 * height_m, 0.0},
                               is_sphere ? std::array{36, 70} : std::array{48, 90});
  block.material = made_elastic(bundled_material("gelatin-20-1"));
  block.material.youngs_modulus_pa = indentation.youngs_modulus_pa;
  block.material.poissons_ratio = indentation.poissons_ratio;
  const int across = static_cast<int>(std::lround(indentation.cells_high * 2.0 * radius_m / height_m));
  block.lattice.counts = {{across + 1, indentation.cells_high + 1, across + 1}};
  block.lattice.cells = LatticeCells::box;
  return block;
}

Body make_indenter(Indenter kind) {
  Body body;
  body.name = "indenter";
  body.kind = BodyKind::fixed;
  body.material = bundled_material("steel-304");
  if (kind == Indenter::sphere) {
    body.surface =
        stock_surface(SphereSize{sphere_radius_m}, {0.0, height_m + start_m + sphere_radius_m, 0.0});
    return body;
  }
  // The edge is as sharp as a stock shape can be: 0.1 mm. In CalculiX, an edge of 0.4 mm lowers the force
  // at a depth of 0.5 mm by 4 %.
  constexpr double length_m = 0.01, edge_m = 0.0001;
  body.surface = fine_surface(CylinderSize{punch_radius_m, length_m, edge_m},
                              {0.0, height_m + start_m + 0.5 * length_m, 0.0}, {40, 60});
  return body;
}

Scene indented_scene(const Indentation& indentation) {
  Scene scene = settling_scene({round_block(indentation), make_indenter(indentation.indenter)});
  const double friction = indentation.indenter == Indenter::bonded_punch ? bonding_friction : 0.0;
  for (Body& body : scene.bodies) body.material.friction = friction;
  scene.planes = {{Vector3(0.0, 1e-4, 0.0), Vector3::UnitY()}};  // fixes the nodes of the base
  return scene;
}

// Moves the indenter down and returns the force on it, N, once the force changes by less than 0.5 % a
// second.
double press(Simulation& simulation, double way_m) {
  constexpr double speed_m_per_s = 0.005, largest_change = 5e-4;  // change in `mean_ticks`
  constexpr int rest_ticks = 200, mean_ticks = 100, longest_rest = 20;
  const double seconds = std::max(0.2, way_m / speed_m_per_s);
  const BodyMotion down{Vector3::Zero(), {{seconds, {0.0, -way_m, 0.0}}}};
  EXPECT_TRUE(simulation.apply(MoveBody{1, down}).ok());
  advance(simulation, static_cast<int>(std::lround(seconds / tick_s)) + rest_ticks, idle_tool());
  double last_n = 0.0;
  for (int rest = 0; rest < longest_rest; ++rest) {
    const double force_n =
        mean_over(simulation, mean_ticks, idle_tool(), [&] { return -simulation.contact_force_n(0).y(); });
    if (std::abs(force_n - last_n) < largest_change * force_n) return force_n;
    last_n = force_n;
  }
  ADD_FAILURE() << "the gel does not come to rest";
  return last_n;
}

class IndentedGel : public testing::TestWithParam<Indentation> {};

TEST_P(IndentedGel, PushesBackAsInFiniteElements) {
  const Indentation& indentation = GetParam();
  if (const std::string reason = find_skip_reason(indentation.run); !reason.empty()) GTEST_SKIP() << reason;
  Simulation simulation = make_simulation(indented_scene(indentation));
  double pressed_m = -start_m;
  for (const Depth& depth : indentation.depths) {
    const double force_n = press(simulation, depth.depth_m - pressed_m);
    pressed_m = depth.depth_m;
    const double exact_n = depth.oracle_n * indentation.youngs_modulus_pa / oracle_modulus_pa;
    const std::string what = "at " + std::to_string(1e3 * depth.depth_m).substr(0, 3) + " mm";
    print_result(indentation.name, what, force_n, "N");
    print_result(indentation.name, what + ": over CalculiX", force_n / exact_n);
    if (depth.tolerance > 0.0) {
      EXPECT_NEAR(force_n / exact_n, 1.0, depth.tolerance) << what;
    }
  }
}

std::vector<Indentation> all_indentations() {
  using enum Indenter;
  const auto always = ForceRun::always, full = ForceRun::full, table = ForceRun::whole_table;
  return {
      // At 0.5 mm, the radius of the contact would be 1.8 of these cells, which are too few for the bound.
      {"Hertz5kPaNu49Coarse", sphere, 5e3, 0.49, 16, {hertz_49[1]}, always},
      {"Hertz900kPaNu45Coarse", sphere, 9e5, 0.45, 20, {hertz_45[1]}, full},
      {"Hertz900kPaNu49", sphere, 9e5, 0.49, 25, hertz_49, table},
      {"Hertz900kPaNu45", sphere, 9e5, 0.45, 25, hertz_45, table},
      {"Hertz50kPaNu49", sphere, 5e4, 0.49, 25, hertz_49, table},
      {"Hertz50kPaNu45", sphere, 5e4, 0.45, 25, hertz_45, table},
      {"Hertz5kPaNu49", sphere, 5e3, 0.49, 25, hertz_49, table},
      {"Hertz5kPaNu45", sphere, 5e3, 0.45, 25, hertz_45, table},
      {"BloomBonded10Cells", bonded_punch, 5e3, 0.49, 32, bloom_bonded, table},
      {"BloomSlipping10Cells", slipping_punch, 5e3, 0.49, 32, bloom_slipping, table},
  };
}

INSTANTIATE_TEST_SUITE_P(Table, IndentedGel, testing::ValuesIn(all_indentations()),
                         [](const testing::TestParamInfo<Indentation>& info) { return info.param.name; });

}  // namespace
}  // namespace spoonbill
