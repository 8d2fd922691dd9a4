#include "app/undo/stroke_history.h"

#include <gtest/gtest.h>

#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

// A simulation that is touched by hand, with its history.
struct Touched {
  Simulation simulation = Simulation::make(small_handle(), InstructionSet::baseline).value();
  StrokeHistory history{simulation};
  CouplingState coupling;
  DeviceSpecification device = VirtualDevice::default_specification();

  Touched() { EXPECT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}})); }

  bool hold(double height_m, int ticks) {
    bool touched = false;
    Pose pose;
    pose.position_m = Vector3(0.05, height_m, 0.0);
    for (int i = 0; i < ticks; ++i) {
      const TickResult result = tick(simulation, coupling, device, DeviceReading::from(pose, 0));
      history.after_tick(simulation, result.touching);
      touched = touched || result.touching;
    }
    return touched;
  }

  // Comes down until it touches, presses a little further and goes. Returns the shape before the touch.
  ShapeState stroke() {
    ShapeState before = simulation.shape();
    double height_m = 0.03;
    while (height_m > -0.05 && !hold(height_m, 1)) {
      height_m -= 1e-4;
      before = simulation.shape();
    }
    EXPECT_GT(height_m, -0.05);
    hold(height_m - 0.001, 40);
    hold(0.03, 200);
    return before;
  }
};

TEST(StrokeHistory, UndoGivesTheShapeBeforeTheStrokeBitForBit) {
  Touched touched;
  touched.history.clear(touched.simulation);
  EXPECT_FALSE(touched.history.can_undo());
  const ShapeState before = touched.stroke();
  EXPECT_NE(touched.simulation.shape(), before);
  ASSERT_TRUE(touched.history.can_undo());
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
  EXPECT_FALSE(touched.history.can_undo());
}

TEST(StrokeHistory, WalksBackAndForthOverSeveralStrokes) {
  Touched touched;
  touched.history.clear(touched.simulation);
  std::vector<ShapeState> shapes;
  for (int i = 0; i < 3; ++i) {
    shapes.push_back(touched.stroke());
  }
  const ShapeState last = touched.simulation.shape();
  for (int i = 2; i >= 0; --i) {
    ASSERT_TRUE(touched.history.undo(touched.simulation));
    EXPECT_EQ(touched.simulation.shape(), shapes[static_cast<std::size_t>(i)]) << i;
  }
  EXPECT_FALSE(touched.history.can_undo());
  for (int i = 1; i < 3; ++i) {
    ASSERT_TRUE(touched.history.redo(touched.simulation));
    EXPECT_EQ(touched.simulation.shape(), shapes[static_cast<std::size_t>(i)]) << i;
  }
  ASSERT_TRUE(touched.history.redo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), last);
  EXPECT_FALSE(touched.history.can_redo());
}

TEST(StrokeHistory, ANewStrokeAfterUndoForgetsWhatWasUndone) {
  Touched touched;
  touched.history.clear(touched.simulation);
  touched.stroke();
  touched.stroke();
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  const ShapeState before = touched.stroke();
  EXPECT_FALSE(touched.history.can_redo());
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
  EXPECT_TRUE(touched.history.can_undo());
}

TEST(StrokeHistory, ABounceDoesNotEndAStroke) {
  Touched touched;
  touched.history.clear(touched.simulation);
  touched.hold(0.009, 40);
  touched.hold(0.03, StrokeHistory::release_ticks - 10);
  touched.hold(0.009, 40);
  touched.hold(0.03, 200);
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_FALSE(touched.history.can_undo());
}

TEST(StrokeHistory, WithoutStrokesNothingHappens) {
  Touched touched;
  touched.history.clear(touched.simulation);
  const ShapeState before = touched.simulation.shape();
  EXPECT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_TRUE(touched.history.redo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
}

TEST(ShapeDifference, KeepsOnlyWhatDiffersToTheLastBit) {
  ShapeState before{{0.0F, 1.0F, 2.0F, 3.0F}};
  ShapeState after{{-0.0F, 1.0F, 2.5F, 3.0F}};
  const ShapeDifference change = difference(before, after);
  ASSERT_EQ(change.size(), 2U);
  ShapeState shape = after;
  take_back(shape, change);
  EXPECT_TRUE(difference(shape, before).empty());
  do_again(shape, change);
  EXPECT_TRUE(difference(shape, after).empty());
}

}  // namespace
}  // namespace spoonbill
