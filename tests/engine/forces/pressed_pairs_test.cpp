// Tests that two bodies pressed against each other push with equal forces, and that their interface is where
// the face of each body alone would be under this force.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "engine/material/statics/static_solver.h"
#include "engine/simulation/body_state.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

struct Pair {
  const char *left, *right;  // names of bundled materials
  double press_m;            // pressing distance, far less than a block needs to buckle
  int node_budget;
  ForceRun run;
};

void PrintTo(const Pair& pair, std::ostream* out) {
  *out << pair.left << " against " << pair.right;
}

constexpr double length_m = 0.02, width_m = 0.014, rounding_m = 0.001;
// Tolerance of the fit of a block's surface. It is larger than the default, so that fewer control points
// suffice and contacts take less time.
constexpr double tolerance_m = 2e-5;

// Returns a block along x with its contact face at x = 0, fixed at the other end.
Body make_block(bool on_left, const std::string& material, int node_budget) {
  BoxSize size;
  size.size_m = {length_m, width_m, width_m};
  size.rounding_m = rounding_m;
  const Vector3 centre(on_left ? -0.5 * length_m : 0.5 * length_m, 0.0, 0.0);
  Body body;
  body.name = material;
  body.surface = stock_surface(size, centre, tolerance_m);
  body.material = made_elastic(bundled_material(material));
  body.lattice.node_budget = node_budget;
  body.supports.push_back({end_region(body.surface, 0, !on_left, 0.1)});
  return body;
}

// A point of the contact face and the part of the face's area that it represents.
struct FacePoint {
  EmbeddedPoint nodes;
  double fraction = 0.0;
};

// Returns evenly spaced points of the flat part of the contact face.
std::vector<FacePoint> sample_face(const BodyState& body) {
  // The face takes only a short part of the parameter along the body, so many steps are needed.
  constexpr int steps = 40, steps_along = 2000;
  const Surface& surface = body.mapping().rest();
  std::vector<FacePoint> points;
  double area = 0.0;
  for (int a = 0; a < steps; ++a) {
    for (int b = 0; b < steps_along; ++b) {
      const double u = surface.u.parameter_at((a + 0.5) / steps),
                   v = surface.v.parameter_at((b + 0.5) / steps_along);
      const SurfacePoint at = evaluate(surface, u, v);
      if (std::abs(at.position_m.x()) > 1.5 * tolerance_m) continue;  // this point is beside the flat part
      points.push_back({body.mapping().at(u, v), at.du.cross(at.dv).norm()});
      area += points.back().fraction;
    }
  }
  for (FacePoint& point : points) point.fraction /= area;
  return points;
}

// Returns the mean displacement of the contact face along x.
template <class DisplacementOf>
double face_displacement_m(const std::vector<FacePoint>& face, const DisplacementOf& displacement_of) {
  double sum = 0.0;
  for (const FacePoint& point : face) {
    for (int n = 0; n < point.nodes.count; ++n) {
      const auto at = static_cast<std::size_t>(n);
      sum += point.fraction * static_cast<double>(point.nodes.weight[at]) *
             displacement_of(point.nodes.node[at]).x();
    }
  }
  return sum;
}

// Returns the displacement of the contact face at rest under a force along x that is spread evenly over the
// face.
double displacement_at_rest_m(const Body& definition, double force_n) {
  const BodyState body = make_body_state(definition, {}, InstructionSet::baseline).value();
  const std::vector<FacePoint> face = sample_face(body);
  std::vector<Vector3> force_by_node(body.fixed.size(), Vector3::Zero());
  for (const FacePoint& point : face) {
    for (int n = 0; n < point.nodes.count; ++n) {
      const auto at = static_cast<std::size_t>(n);
      force_by_node[static_cast<std::size_t>(point.nodes.node[at])].x() +=
          point.fraction * static_cast<double>(point.nodes.weight[at]) * force_n;
    }
  }
  StaticLoads loads;
  std::vector<FixedAxis> fixed;
  for (std::size_t n = 0; n < force_by_node.size(); ++n) {
    if (body.fixed[n] != 0) {
      fix_node(static_cast<int>(n), Vector3::Zero(), fixed);
    } else if (!force_by_node[n].isZero(0.0)) {
      loads.forces.push_back({static_cast<int>(n), force_by_node[n]});
    }
  }
  const CellKind kind = body.implicit_solver ? CellKind::hexahedra : CellKind::springs;
  const StaticBody at_rest = StaticBody::make(body.lattice.mesh(), body.lattice.materials(), kind).value();
  const StaticResult result = rest_under_load(at_rest, loads, fixed).value();
  return face_displacement_m(face,
                             [&](int node) { return result.displacement_m[static_cast<std::size_t>(node)]; });
}

class PressedPairs : public testing::TestWithParam<Pair> {};

TEST_P(PressedPairs, PushWithEqualForces) {
  const Pair& pair = GetParam();
  if (const std::string reason = find_skip_reason(pair.run); !reason.empty()) GTEST_SKIP() << reason;
  Scene scene = settling_scene(
      {make_block(true, pair.left, pair.node_budget), make_block(false, pair.right, pair.node_budget)});
  SupportMotion press;
  press.displacement_m = {-pair.press_m, 0.0, 0.0};
  press.duration_s = 0.3;
  scene.bodies[1].supports[0].motion = press;
  Simulation simulation = make_simulation(scene);
  std::vector<FacePoint> faces[2];
  for (std::size_t b = 0; b < 2; ++b) {
    faces[b] = sample_face(make_body_state(scene.bodies[b], {}, InstructionSet::baseline).value());
    ASSERT_FALSE(faces[b].empty());
  }
  const auto face_m = [&](int body) {
    return face_displacement_m(faces[body],
                               [&](int node) { return simulation.lattice(body).displacement(node); });
  };
  const bool is_short = !find_skip_reason(ForceRun::full).empty();
  advance(simulation, is_short ? 450 : 800, idle_tool());
  double left_n = 0.0, right_n = 0.0, left_m = 0.0, right_m = 0.0;
  const int ticks = is_short ? 100 : 500;
  for (int tick = 0; tick < ticks; ++tick) {
    simulation.advance(idle_tool());
    left_n += simulation.support_force_n(0, 0).x() / ticks;
    right_n += simulation.support_force_n(0, 1).x() / ticks;
    left_m += face_m(0) / ticks;
    right_m += face_m(1) / ticks;
  }
  const std::string what = std::string(pair.left) + " against " + pair.right;
  print_result("pressed pairs", what + ": mean force", left_n, "N");
  print_result("pressed pairs", what + ": force ratio", -right_n / left_n);
  EXPECT_GT(left_n, 0.0);
  EXPECT_NEAR(-right_n / left_n, 1.0, 1e-3);
  const double left_rest_m = displacement_at_rest_m(scene.bodies[0], -left_n);
  const double right_rest_m = displacement_at_rest_m(scene.bodies[1], left_n) - pair.press_m;
  print_result("pressed pairs", what + ": left interface misses rest by",
               (left_m - left_rest_m) / pair.press_m, "press depths");
  print_result("pressed pairs", what + ": right interface misses rest by",
               (right_m - right_rest_m) / pair.press_m, "press depths");
  EXPECT_NEAR(left_m, left_rest_m, 0.03 * pair.press_m);
  EXPECT_NEAR(right_m, right_rest_m, 0.03 * pair.press_m);
}

INSTANTIATE_TEST_SUITE_P(, PressedPairs,
                         testing::Values(Pair{"gelatin-20-1", "silicone-00-30", 5e-4, 200, ForceRun::always},
                                         Pair{"gelatin-20-1", "abs", 5e-4, 200, ForceRun::whole_table},
                                         Pair{"silicone-00-30", "steel-304", 5e-4, 200,
                                              ForceRun::whole_table},
                                         Pair{"silicone-soft", "polypropylene", 5e-4, 200, ForceRun::full},
                                         Pair{"silicone-hard", "abs", 5e-4, 200, ForceRun::whole_table},
                                         Pair{"abs", "steel-304", 1e-4, 200, ForceRun::whole_table}));

}  // namespace
}  // namespace spoonbill
