#include "app/session/edit_history.h"

#include <gtest/gtest.h>

#include "app/session/session.h"
#include "engine/simulation/body_mapping.h"
#include "engine/simulation/refiner.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"
#include "tests/engine/allocations.h"
#include "tests/engine/effort.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

// Returns an elastic handle of so few nodes that a tick takes a fraction of the usual time. Because it is
// elastic, many strokes do not press it out of the tool's reach.
Scene coarse_handle() {
  Scene scene = small_handle();
  scene.bodies[0].lattice.node_budget = 150;
  scene.bodies[0].material.plastic = false;
  scene.tool.substeps = 1;
  return scene;
}

Simulation make_held_handle() {
  Simulation simulation = Simulation::make(coarse_handle(), InstructionSet::baseline).value();
  EXPECT_TRUE(simulation.apply(PlacePlane{{Vector3(0.02, 0, 0), Vector3::UnitX()}}));
  return simulation;
}

// A simulation with its history and a tool that the test moves.
struct Touched {
  Simulation simulation = make_held_handle();
  EditHistory history{simulation};
  CouplingState coupling;
  DeviceSpecification device = VirtualDevice::default_specification();

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

  // Lowers the tool until it touches, then presses a little further. Returns the shape before the contact.
  ShapeState press() {
    ShapeState before = simulation.shape();
    double height_m = 0.011;
    while (height_m > -0.05 && !hold(height_m, 1)) {
      height_m -= 4e-4;
      before = simulation.shape();
    }
    EXPECT_GT(height_m, -0.05);
    hold(height_m - 0.0003, 40);
    return before;
  }

  ShapeState stroke() {
    ShapeState before = press();
    hold(0.03, EditHistory::release_ticks + 10);
    return before;
  }
};

TEST(EditHistory, UndoGivesTheShapeBeforeTheStrokeBitForBit) {
  Touched touched;
  EXPECT_FALSE(touched.history.can_undo());
  const ShapeState before = touched.stroke();
  EXPECT_NE(touched.simulation.shape(), before);
  ASSERT_TRUE(touched.history.can_undo());
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
  EXPECT_FALSE(touched.history.can_undo());
}

TEST(EditHistory, UndoGivesBackTheShapeHash) {
  Touched touched;
  const std::uint64_t start = shape_hash(touched.simulation);
  touched.hold(0.03, 20);
  EXPECT_EQ(shape_hash(touched.simulation), start) << "ticks do not count";
  Tool tool = touched.simulation.scene().tool;
  tool.radius_m *= 1.5;
  ASSERT_TRUE(touched.simulation.apply(SetTool{tool}));
  EXPECT_EQ(shape_hash(touched.simulation), start) << "the tool does not count";
  touched.stroke();
  EXPECT_NE(shape_hash(touched.simulation), start);
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(shape_hash(touched.simulation), start);
}

TEST(EditHistory, TheShapeHashHasMaterialsAndPlanes) {
  Touched touched;
  const std::uint64_t start = shape_hash(touched.simulation);
  const Material before = touched.simulation.scene().bodies[0].material;
  Material stiffer = before;
  stiffer.youngs_modulus_pa *= 1.01;
  ASSERT_TRUE(touched.simulation.apply(SetMaterial{stiffer}));
  EXPECT_NE(shape_hash(touched.simulation), start);
  ASSERT_TRUE(touched.simulation.apply(SetMaterial{before}));
  EXPECT_EQ(shape_hash(touched.simulation), start);
  ASSERT_TRUE(touched.simulation.apply(PlacePlane{{Vector3(0.01, 0, 0), Vector3::UnitX()}}));
  EXPECT_NE(shape_hash(touched.simulation), start);
}

TEST(EditHistory, WalksBackAndForthOverSeveralStrokes) {
  Touched touched;
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

// Commands between strokes are steps like strokes. Refinements in given ranges belong to the stroke.
TEST(EditHistory, WalksOverStrokesAndCommands) {
  Touched touched;
  Simulation& simulation = touched.simulation;
  Material stiffer = simulation.scene().bodies[0].material;
  stiffer.youngs_modulus_pa *= 1.5;
  const std::vector<Command> commands = {RefineKnots{}, PlacePlane{{Vector3(0.03, 0, 0), Vector3::UnitX()}},
                                         SetMaterial{stiffer}, RemovePlanes{}, KeepShape{}};
  std::vector<std::uint64_t> hashes;
  const auto remember = [&] {
    touched.hold(0.03, catch_up_ticks + 1);
    hashes.push_back(shape_hash(simulation));
  };
  for (const Command& command : commands) {
    hashes.push_back(shape_hash(simulation));
    touched.press();
    ASSERT_TRUE(touched.history.apply(simulation, RefineKnots{0, Range<double>{0.4, 0.6}, {}}));
    touched.hold(0.03, EditHistory::release_ticks + 10);
    touched.hold(0.03, 300);  // until a stroke on an elastic body is at rest
    remember();
    const Status applied = touched.history.apply(simulation, command);
    ASSERT_TRUE(applied) << applied.error().message;
  }
  remember();
  for (std::size_t k = hashes.size() - 1; k > 0; --k) {
    ASSERT_TRUE(touched.history.can_undo()) << k;
    ASSERT_TRUE(touched.history.undo(simulation));
  }
  EXPECT_FALSE(touched.history.can_undo());
  EXPECT_EQ(shape_hash(simulation), hashes.front());
  while (touched.history.can_redo()) ASSERT_TRUE(touched.history.redo(simulation));
  EXPECT_EQ(shape_hash(simulation), hashes.back());
}

TEST(EditHistory, ChangesOfOneMaterialAreOneStep) {
  Touched touched;
  const Material before = touched.simulation.scene().bodies[0].material;
  const std::uint64_t start = shape_hash(touched.simulation);
  for (int k = 1; k <= 5; ++k) {
    Material stiffer = before;
    stiffer.youngs_modulus_pa *= 1.0 + 0.1 * k;
    ASSERT_TRUE(touched.history.apply(touched.simulation, SetMaterial{stiffer}));
    touched.hold(0.03, 10);
  }
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(shape_hash(touched.simulation), start);
  EXPECT_FALSE(touched.history.can_undo());
}

// A refinement belongs to a step. A cancelled stroke leaves no step, and requests no refinement.
TEST(EditHistory, ACancelledStrokeRefinesNothing) {
  Touched touched;
  touched.press();
  ASSERT_TRUE(touched.history.in_stroke());
  ASSERT_TRUE(touched.history.cancel(touched.simulation));
  EXPECT_FALSE(touched.simulation.wanted_refinement());
  EXPECT_FALSE(touched.history.has_open_step());
  ASSERT_TRUE(touched.history.apply(touched.simulation, RefineKnots{0, Range<double>{0.4, 0.6}, {}}));
  EXPECT_TRUE(touched.history.can_undo()) << "asked for outside a step, it is a step";
}

TEST(EditHistory, ARefusedCommandIsNoStep) {
  Touched touched;
  EXPECT_FALSE(touched.history.apply(touched.simulation, RefineKnots{5}));
  EXPECT_FALSE(touched.history.can_undo());
}

TEST(EditHistory, KeepsTheNewestBuilds) {
  Touched touched;
  std::vector<std::uint64_t> hashes;
  for (std::size_t k = 0; k < EditHistory::build_limit + 4; ++k) {
    const double x_m = 0.02 + 2e-4 * static_cast<double>(k);
    ASSERT_TRUE(touched.history.apply(touched.simulation, RemovePlanes{}));
    ASSERT_TRUE(
        touched.history.apply(touched.simulation, PlacePlane{{Vector3(x_m, 0, 0), Vector3::UnitX()}}));
  }
  std::size_t undone = 0;
  for (; touched.history.can_undo(); ++undone) ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(undone, EditHistory::build_limit);
}

TEST(EditHistory, ANewStrokeAfterUndoForgetsWhatWasUndone) {
  Touched touched;
  touched.stroke();
  touched.stroke();
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  const ShapeState before = touched.stroke();
  EXPECT_FALSE(touched.history.can_redo());
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
  EXPECT_TRUE(touched.history.can_undo());
}

TEST(EditHistory, ABounceDoesNotEndAStroke) {
  Touched touched;
  touched.hold(0.009, 40);
  touched.hold(0.03, EditHistory::release_ticks - 10);
  touched.hold(0.009, 40);
  touched.hold(0.03, 200);
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_FALSE(touched.history.can_undo());
}

TEST(EditHistory, WithoutStrokesNothingHappens) {
  Touched touched;
  const ShapeState before = touched.simulation.shape();
  EXPECT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_TRUE(touched.history.redo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
}

TEST(EditHistory, CancelForgetsTheStrokeUnderWay) {
  Touched touched;
  touched.stroke();
  const ShapeState before = touched.press();
  ASSERT_TRUE(touched.history.in_stroke());
  ASSERT_TRUE(touched.history.cancel(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), before);
  EXPECT_FALSE(touched.history.can_redo());
  ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_NE(touched.simulation.shape(), before);
}

TEST(EditHistory, CancelWithoutAStrokeDoesNothing) {
  Touched touched;
  touched.stroke();
  const ShapeState after = touched.simulation.shape();
  ASSERT_TRUE(touched.history.cancel(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), after);
}

TEST(EditHistory, KeepsTheNewestWhenItIsFull) {
  if (sanitized) GTEST_SKIP() << long_when_sanitized;
  Touched touched;
  const int strokes = static_cast<int>(EditHistory::shape_limit) + 6;
  std::vector<ShapeState> befores;
  for (int i = 0; i < strokes; ++i) befores.push_back(touched.stroke());
  const ShapeState last = touched.simulation.shape();
  int undone = 0;
  for (; touched.history.can_undo(); ++undone) ASSERT_TRUE(touched.history.undo(touched.simulation));
  EXPECT_EQ(undone, static_cast<int>(EditHistory::shape_limit) - 1);
  EXPECT_EQ(touched.simulation.shape(), befores[static_cast<std::size_t>(strokes - undone)]);
  while (touched.history.can_redo()) ASSERT_TRUE(touched.history.redo(touched.simulation));
  EXPECT_EQ(touched.simulation.shape(), last);
}

TEST(EditHistory, FollowsTheTicksWithoutAllocating) {
  Touched touched;
  touched.hold(0.03, 2);
  const std::size_t before = allocation_count();
  for (int i = 0; i < 5; ++i) {
    touched.hold(0.0, 5);
    touched.hold(0.03, EditHistory::release_ticks + 1);
  }
  EXPECT_EQ(allocation_count(), before);
}

// Strokes during which a refiner refines the surface.
struct RefinedStrokes {
  Touched touched;
  Refiner refiner{touched.simulation};

  int columns() const { return touched.simulation.surface().net.columns; }
  // Presses, refines one element of v while the tool touches, and moves away.
  void stroke(double v_m) {
    touched.press();
    ASSERT_TRUE(touched.history.in_stroke());
    ASSERT_TRUE(refiner.prepare(RefineKnots{0, std::nullopt, Range<double>{v_m, v_m}}));
    const std::size_t before = allocation_count();
    touched.history.adopt(touched.simulation, refiner);
    EXPECT_EQ(allocation_count(), before);
    touched.hold(0.03, EditHistory::release_ticks + catch_up_ticks);
  }
};

TEST(EditHistory, TakesBackTheRefinementsOfAStrokeWithIt) {
  RefinedStrokes strokes;
  Simulation& simulation = strokes.touched.simulation;
  EditHistory& history = strokes.touched.history;
  const std::uint64_t start = shape_hash(simulation);
  std::vector<int> columns = {strokes.columns()};
  for (const double v_m : {0.0311, 0.0312, 0.0421}) {
    strokes.stroke(v_m);
    columns.push_back(strokes.columns());
    EXPECT_GT(columns.back(), columns[columns.size() - 2]);
  }
  const std::uint64_t end = shape_hash(simulation);
  for (std::size_t s = columns.size() - 1; s > 0; --s) {
    EXPECT_TRUE(history.undo_needs_build());
    ASSERT_TRUE(history.undo(simulation));
    EXPECT_EQ(strokes.columns(), columns[s - 1]);
  }
  EXPECT_FALSE(history.can_undo());
  EXPECT_EQ(shape_hash(simulation), start);
  while (history.can_redo()) ASSERT_TRUE(history.redo(simulation));
  EXPECT_EQ(strokes.columns(), columns.back());
  EXPECT_EQ(shape_hash(simulation), end);
}

// A new material and then a stroke with a refinement: each undo restores what its step has changed.
TEST(EditHistory, KeepsWholeBuildsAndMappingsApart) {
  RefinedStrokes strokes;
  Simulation& simulation = strokes.touched.simulation;
  EditHistory& history = strokes.touched.history;
  const double first_pa = simulation.scene().bodies[0].material.youngs_modulus_pa;
  const int first_columns = strokes.columns();
  Material stiffer = simulation.scene().bodies[0].material;
  stiffer.youngs_modulus_pa *= 2.0;
  ASSERT_TRUE(history.apply(simulation, SetMaterial{stiffer}));
  strokes.refiner = Refiner(simulation);
  strokes.stroke(0.0311);
  const std::uint64_t end = shape_hash(simulation);
  ASSERT_TRUE(history.undo(simulation));
  EXPECT_EQ(strokes.columns(), first_columns);
  EXPECT_EQ(simulation.lattice().material().youngs_modulus_pa, 2.0 * first_pa);
  ASSERT_TRUE(history.undo(simulation));
  EXPECT_EQ(simulation.lattice().material().youngs_modulus_pa, first_pa);
  EXPECT_FALSE(history.can_undo());
  while (history.can_redo()) ASSERT_TRUE(history.redo(simulation));
  EXPECT_EQ(shape_hash(simulation), end);
}

// With more refinements than builds are kept, the oldest steps go.
TEST(EditHistory, KeepsTheNewestRefinementsWhenItIsFull) {
  RefinedStrokes strokes;
  Simulation& simulation = strokes.touched.simulation;
  EditHistory& history = strokes.touched.history;
  const int first_columns = strokes.columns();
  constexpr int stroke_count = static_cast<int>(EditHistory::build_limit) + 6;
  for (int s = 0; s < stroke_count; ++s) strokes.stroke(0.0211 + 0.0011 * s);
  const std::uint64_t end = shape_hash(simulation);
  int undone = 0;
  for (; history.can_undo(); ++undone) ASSERT_TRUE(history.undo(simulation));
  EXPECT_LE(undone, static_cast<int>(EditHistory::build_limit));
  EXPECT_GE(undone, static_cast<int>(EditHistory::build_limit) - 1);
  EXPECT_GT(strokes.columns(), first_columns);
  while (history.can_redo()) ASSERT_TRUE(history.redo(simulation));
  EXPECT_EQ(shape_hash(simulation), end);
}

}  // namespace
}  // namespace spoonbill
