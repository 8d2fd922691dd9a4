#include "engine/collision/rigid/body_tree.h"

#include <gtest/gtest.h>

#include "tests/engine/collision/meshes/mesh_shapes.h"

namespace spoonbill {
namespace {

std::vector<Box> random_boxes(Random& random, int count, double extent_m) {
  std::vector<Box> boxes;
  for (int k = 0; k < count; ++k) {
    const Vector3 low = random_point(random, extent_m);
    const Vector3 sides = random_point(random, 0.1).cwiseAbs();
    boxes.push_back({low, low + sides});
  }
  return boxes;
}

TEST(BodyTree, PicksThePairsThatALookAtAllOfThemFinds) {
  Random random(5);
  for (const int count : {0, 1, 2, 3, 17, 300}) {
    const std::vector<Box> boxes = random_boxes(random, count, 0.4), others = random_boxes(random, 40, 0.4);
    std::vector<BodyPair> within, between;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size(); ++j) {
        if (boxes[i].is_near(boxes[j], 0.0)) within.emplace_back(i, j);
      }
      for (std::size_t j = 0; j < others.size(); ++j) {
        if (boxes[i].is_near(others[j], 0.0)) between.emplace_back(i, j);
      }
    }
    const BodyTree tree(boxes), other(others);
    EXPECT_EQ(tree.near_pairs(), within) << count;
    EXPECT_EQ(tree.near_pairs(other), between) << count;
  }
}

TEST(BodyTree, BoxesThatTouchAreNear) {
  // A third and a tenth are not exact in binary, so the centres and sides of the boxes are not exact either.
  const double edge = 0.1 + 1.0 / 3.0;
  const BodyTree tree({{{0, 0, 0}, {edge, 1, 1}}, {{edge, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 1}}});
  EXPECT_EQ(tree.near_pairs(), (std::vector<BodyPair>{{0, 1}, {1, 2}}));
}

TEST(BodyTree, TheNearestAreFoundAmongFewPairs) {
  Random random(6);
  const std::vector<Box> boxes = random_boxes(random, 200, 1.0);
  std::vector<Box> others = random_boxes(random, 200, 1.0);
  for (Box& box : others) box = {box.low + Vector3(3, 0, 0), box.high + Vector3(3, 0, 0)};
  double least = 1e300;
  for (const Box& box : boxes) {
    for (const Box& other : others) least = std::min(least, box.gap(other));
  }
  int looks = 0;
  const double found = BodyTree(boxes).find_nearest(BodyTree(others), [&](std::size_t i, std::size_t j) {
    ++looks;
    return boxes[i].gap(others[j]);
  });
  EXPECT_EQ(found, least);
  EXPECT_LT(looks, 400);  // far fewer than the 200 x 200 pairs of boxes
  EXPECT_EQ(BodyTree({}).find_nearest(BodyTree(others), [](std::size_t, std::size_t) { return 0.0; }),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace spoonbill
