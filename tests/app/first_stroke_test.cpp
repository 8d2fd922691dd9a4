#include "tests/app/first_stroke.h"

#include <gtest/gtest.h>

#include "app/session/lockstep.h"
#include "haptic/virtual_device.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

constexpr double lead_m = 0.001;  // gap between tool and surface at the start

// The readings of a hand that presses for half a second, holds for a fifth, and is back above the body for
// more than a second.
struct FirstStroke {
  std::vector<DeviceReading> readings;
  std::uint64_t deepest = 0, after_a_second = 0;

  FirstStroke(const Vector3& touched_m, const Vector3& normal, double radius_m, double travel_m) {
    const auto move = [&](double from_m, double to_m, int ticks, std::uint32_t buttons) {
      for (int t = 1; t <= ticks; ++t) {
        Pose pose;
        pose.position_m = touched_m + (radius_m + from_m + (to_m - from_m) * t / ticks) * normal;
        readings.push_back(DeviceReading::from(pose, buttons));
      }
    };
    move(lead_m, lead_m, 100, 0);
    move(lead_m, -travel_m, 500, button_main);
    move(-travel_m, -travel_m, 200, button_main);
    deepest = readings.size();
    move(-travel_m, 0.02, 150, 0);
    move(0.02, 0.02, 1000, 0);
    after_a_second = readings.size();
  }
};

class FirstStrokes : public testing::TestWithParam<std::size_t> {};

TEST_P(FirstStrokes, ShowUnderTheToolAndStayInClay) {
  const FirstShape& shape = first_shapes()[GetParam()];
  const Workplace place;
  const Document document = make_first_document(shape, place.path(""));
  const Surface rest = document.scene.bodies[0].surface;
  const double radius_m = document.scene.tool.radius_m;
  const PressedPoint pressed(rest, shape.above_m);
  ASSERT_GT(pressed.normal().dot(shape.outward), 0.5);
  const FirstStroke stroke(pressed.start_m(), pressed.normal(), radius_m, shape.travel_m());

  PlaybackDevice device(VirtualDevice::default_specification(), stroke.readings);
  Session session = Session::make(document, "first", device.specification(), best_instruction_set()).value();
  session.reading = stroke.readings.front();
  LockstepInput input;
  input.device = &device;
  input.tick_count = stroke.readings.size();
  input.refines = true;
  Lockstep lockstep(session, std::move(input), nullptr);
  ASSERT_TRUE(lockstep.run_to(stroke.deepest));
  Snapshot snapshot;
  write_snapshot(session, snapshot);
  EXPECT_LT(std::abs(find_gap_m(session.simulation.surface(), snapshot.tool.proxy.position_m, radius_m)),
            0.1 * shape.travel_m());
  ASSERT_TRUE(lockstep.run_to(stroke.after_a_second));
  const double kept_m = pressed.find_depth_m(session.simulation.surface(), 3.0 * radius_m);
  EXPECT_GT(kept_m, 0.7 * shape.travel_m());
  EXPECT_LT(kept_m, 1.2 * shape.travel_m());
}

INSTANTIATE_TEST_SUITE_P(Shapes, FirstStrokes, testing::Range<std::size_t>(0, first_shapes().size()),
                         [](const auto& shape) { return first_shape_name(shape.param); });

}  // namespace
}  // namespace spoonbill
