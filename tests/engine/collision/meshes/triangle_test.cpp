#include "engine/collision/meshes/triangle.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {
namespace {

const Triangle base = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)};

struct TriangleCase {
  const char* name;
  Triangle triangle;
};

// Returns triangles_meet(), and expects the same result for all orders of the corners and both orders of the
// triangles.
bool meets(const Triangle& a, const Triangle& b, double slack = 0.0) {
  const bool answer = triangles_meet(a, b, slack);
  for (int turn = 0; turn < 3; ++turn) {
    const Triangle turned = {b[turn], b[(turn + 1) % 3], b[(turn + 2) % 3]};
    EXPECT_EQ(triangles_meet(a, turned, slack), answer);
    EXPECT_EQ(triangles_meet(turned, a, slack), answer);
    EXPECT_EQ(triangles_meet(a, {turned[2], turned[1], turned[0]}, slack), answer);
  }
  return answer;
}

TEST(Triangles, MeetWhereTheyCrossOrTouch) {
  const TriangleCase cases[] = {
      {"through the middle", {Vector3(.25, .25, -1), Vector3(.25, .25, 1), Vector3(2, 2, 0)}},
      {"over an edge", {Vector3(.5, -.5, -1), Vector3(.5, -.5, 1), Vector3(.5, .1, 0)}},
      {"coplanar, crossing", {Vector3(.2, .2, 0), Vector3(1.2, .2, 0), Vector3(.2, 1.2, 0)}},
      {"coplanar, inside", {Vector3(.2, .2, 0), Vector3(.3, .2, 0), Vector3(.2, .3, 0)}},
      {"a common corner", {Vector3(0, 0, 0), Vector3(-1, 0, 1), Vector3(0, -1, 1)}},
      {"a common edge", {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, -1, 1)}},
      {"a corner on the face", {Vector3(.25, .25, 0), Vector3(.25, .25, 1), Vector3(.5, .25, 1)}},
      {"a corner on an edge", {Vector3(.5, .5, 0), Vector3(1, 1, 1), Vector3(1, .5, 1)}},
  };
  for (const TriangleCase& one : cases) EXPECT_TRUE(meets(base, one.triangle)) << one.name;
}

TEST(Triangles, DoNotMeetWhereTheyAreApart) {
  const TriangleCase cases[] = {
      {"beyond an edge", {Vector3(2, 2, -1), Vector3(2, 2, 1), Vector3(3, 3, 0)}},
      {"a copy above", {Vector3(0, 0, 1e-6), Vector3(1, 0, 1e-6), Vector3(0, 1, 1e-6)}},
      {"coplanar, beyond", {Vector3(.6, .6, 0), Vector3(1, .6, 0), Vector3(.6, 1, 0)}},
      {"a corner lifted", {Vector3(.25, .25, 1e-9), Vector3(.25, .25, 1), Vector3(.5, .25, 1)}},
  };
  for (const TriangleCase& one : cases) EXPECT_FALSE(meets(base, one.triangle)) << one.name;
}

TEST(Triangles, MeetWithinTheirSlack) {
  const Triangle above = {Vector3(.2, .2, .01), Vector3(1, .2, .5), Vector3(.2, 1, .5)};
  EXPECT_TRUE(meets(base, above, 0.0101));
  EXPECT_FALSE(meets(base, above, 0.0099));
}

// A point of one triangle is moved onto a point of the other.
TEST(Triangles, NoCommonPointIsMissed) {
  Random random(31);
  const auto point = [&] {
    return Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  const auto inside = [&](const Triangle& triangle) {
    const double a = random.uniform(0.01, 0.98), b = random.uniform(0.01, 0.99 - a);
    return Vector3(a * triangle[0] + b * triangle[1] + (1.0 - a - b) * triangle[2]);
  };
  for (int repeat = 0; repeat < 20000; ++repeat) {
    const Triangle a = {point(), point(), point()};
    Triangle b = {point(), point(), point()};
    const Vector3 shift = inside(a) - inside(b);
    for (Vector3& corner : b) corner += shift;
    EXPECT_TRUE(triangles_meet(a, b)) << repeat;
  }
}

}  // namespace
}  // namespace spoonbill
