#include <gtest/gtest.h>

#include "engine/collision/surfaces/pair_search.h"
#include "tests/engine/allocations.h"
#include "tests/engine/collision/surfaces/random_pairs.h"

namespace spoonbill {
namespace {

// Returns a point of the net's hull, well inside or on its boundary.
Vector3 point_of_hull(Random& random, const ControlNet& net) {
  Vector3 sum = Vector3::Zero();
  double weights = 0.0;
  for (int k = random.integer(1, 4); k > 0; --k) {
    const double weight = random.uniform(0.01, 1.0);
    sum += weight * net.point(random.integer(0, net.rows - 1), random.integer(0, net.columns - 1));
    weights += weight;
  }
  return sum / weights;
}

double farthest_along(const ControlNet& net, const Vector3& direction) {
  double most = -1e30;
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) most = std::max(most, direction.dot(net.point(i, j)));
  }
  return most;
}

TEST(ConvexHulls, WithACommonPointAreNotApart) {
  Random random(41);
  for (int repeat = 0; repeat < 5000; ++repeat) {
    RandomPair pair = random_pair(random, 0.0);
    move(pair.second, point_of_hull(random, pair.first.net) - point_of_hull(random, pair.second.net));
    EXPECT_FALSE(hulls_are_apart(pair.first.net, pair.second.net)) << repeat;
  }
}

// One net is moved until a plane perpendicular to `direction` separates the two nets.
TEST(ConvexHulls, WithAPlaneBetweenAreApart) {
  Random random(42);
  for (int repeat = 0; repeat < 5000; ++repeat) {
    RandomPair pair = random_pair(random, 0.0);
    const Vector3 direction =
        Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)).normalized();
    const double gap_m = random.uniform(1e-4, 0.1);
    const double along =
        farthest_along(pair.first.net, direction) + farthest_along(pair.second.net, -direction) + gap_m;
    move(pair.second, along * direction);
    EXPECT_TRUE(hulls_are_apart(pair.first.net, pair.second.net)) << repeat << ' ' << gap_m;
    EXPECT_TRUE(hulls_are_apart(pair.second.net, pair.first.net)) << repeat << ' ' << gap_m;
  }
}

TEST(ConvexHulls, AllocateNothing) {
  Random random(43);
  const RandomPair pair = random_pair(random, 1.0);
  const std::size_t before = allocation_count();
  static_cast<void>(hulls_are_apart(pair.first.net, pair.second.net));
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace spoonbill
