// Tests that the points that share a body's mass are where the body is.
#include "engine/trial/mass_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/trial/trial.h"
#include "engine/trial/verdict.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

Simulation ball_in_a_box(const Vector3& centre_m) {
  Body ball =
      stock_body("ball", SphereSize{0.01}, centre_m, made_elastic(bundled_material("gelatin-10-1")), 500);
  ball.lattice.cells = LatticeCells::box;
  ball.lattice.counts = {{8, 8, 8}};
  Scene scene;
  scene.bodies = {ball};
  return make_simulation(make_trial_scene(scene, {}).value());
}

// A ball of 7 cells, 21 points across. The cap begins halfway between two layers of points.
TEST(MassPoints, ShareTheMassOfABall) {
  const Vector3 centre_m(0.02, 0.05, -0.01);
  const Simulation simulation = ball_in_a_box(centre_m);
  const MassPoints points(simulation.lattice(0), simulation.scene().bodies[0].surface);
  double all = 0.0, cap = 0.0, outside = 0.0;
  Vector3 centre = Vector3::Zero();
  points.for_each(simulation.lattice(0), [&](const Vector3& point, double fraction) {
    all += fraction;
    centre += fraction * point;
    if (point.x() > centre_m.x() + 4.5 / 10.5 * 0.01) cap += fraction;
    if ((point - centre_m).norm() > 0.0102) outside += fraction;
  });
  EXPECT_NEAR(all, 1.0, 1e-9);
  EXPECT_LT((centre - centre_m).norm(), 1e-4);
  // A cap of the height h has the fraction h^2 (3 r - h) / (4 r^3).
  const double height = 6.0 / 10.5;
  EXPECT_NEAR(cap, height * height * (3.0 - height) / 4.0, 0.005);
  EXPECT_EQ(outside, 0.0);
}

TEST(Verdict, FollowsFromWhatIsOutside) {
  Spill spill;
  EXPECT_EQ(judge(spill, true), Verdict::holds);
  EXPECT_EQ(judge(spill, false), Verdict::undecided);
  spill.outside_fraction = overhang_limit_fraction;
  EXPECT_EQ(judge(spill, true), Verdict::overhangs);
  EXPECT_EQ(judge(spill, false), Verdict::undecided);
  spill.left_s = 1.0;
  EXPECT_EQ(judge(spill, false), Verdict::leaves);
  spill.left_s.reset();
  spill.first_spill_s = 1.0;
  EXPECT_EQ(judge(spill, true), Verdict::leaves);
}

}  // namespace
}  // namespace spoonbill
