#include <gtest/gtest.h>

#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

TEST(Box, StartsEmptyAndGrows) {
  Box box;
  EXPECT_TRUE(box.is_empty());
  box.include({1, 2, 3});
  EXPECT_FALSE(box.is_empty());
  EXPECT_EQ(box.size(), 0.0);
  box.include({-1, 4, 3});
  EXPECT_EQ(box.low, Vector3(-1, 2, 3));
  EXPECT_EQ(box.high, Vector3(1, 4, 3));
  EXPECT_EQ(box.centre(), Vector3(0, 3, 3));
  EXPECT_EQ(box.extent(), Vector3(2, 2, 0));
}

TEST(Box, AnEmptyOneAddsNothing) {
  Box box = box_about(std::vector<Vector3>{{0, 0, 0}, {1, 1, 1}});
  box.join(Box());
  EXPECT_EQ(box.low, Vector3(0, 0, 0));
  EXPECT_EQ(box.high, Vector3(1, 1, 1));
  EXPECT_TRUE(box_about(std::vector<Vector3>()).is_empty());
}

TEST(Box, CornersCountThroughTheAxes) {
  const Box box{{0, 10, 20}, {1, 11, 21}};
  EXPECT_EQ(box.corner(0), box.low);
  EXPECT_EQ(box.corner(1), Vector3(1, 10, 20));
  EXPECT_EQ(box.corner(2), Vector3(0, 11, 20));
  EXPECT_EQ(box.corner(4), Vector3(0, 10, 21));
  EXPECT_EQ(box.corner(7), box.high);
}

TEST(Box, TellsNearFromFar) {
  const Box box{{0, 0, 0}, {1, 1, 1}}, beside{{1, 0, 0}, {2, 1, 1}}, far{{4, 5, 0}, {5, 6, 1}};
  EXPECT_TRUE(box.overlaps(beside)) << "they have a side in common";
  EXPECT_FALSE(box.overlaps(far));
  EXPECT_EQ(box.gap(far), 5.0);
  EXPECT_TRUE(box.is_near(far, 4.0));
  EXPECT_FALSE(box.is_near(far, 3.9));
  EXPECT_EQ(box.squared_distance({0.5, 0.5, 0.5}), 0.0);
  EXPECT_EQ(box.squared_distance({4, 5, 0.5}), 25.0);
  EXPECT_TRUE(joined(box, far).holds(box));
  EXPECT_FALSE(box.holds(joined(box, far)));
}

}  // namespace
}  // namespace spoonbill
