#include "haptic/virtual_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spoonbill {
namespace {

VirtualDevice device_at_origin(const Hand& hand = {}) {
  return VirtualDevice::make(hand, {}).value();
}

HandTarget target_at_m(double x) {
  HandTarget target;
  target.pose.position_m = Vector3(x, 0.0, 0.0);
  return target;
}

TEST(VirtualDevice, StaysWhereTheTargetStays) {
  VirtualDevice device = device_at_origin();
  for (int tick = 0; tick < 100; ++tick) EXPECT_EQ(device.read(), DeviceReading{});
}

TEST(VirtualDevice, GivesWayByForceOverStiffness) {
  VirtualDevice device = device_at_origin();
  device.set_force(Vector3(0.0, 1.5, 0.0));
  for (int tick = 0; tick < 3000; ++tick) device.read();
  EXPECT_NEAR(device.position_m().y(), 1.5 / 300.0, 1e-12);
  EXPECT_NEAR(device.velocity_m_per_s().norm(), 0.0, 1e-9);
}

// A critically damped hand moves by x(t) = F/k (1 - (1 + w t) exp(-w t)), where F is the force, k the
// stiffness and w the natural frequency. A first-order integrator with step h has a relative error of about
// w h / 2.
TEST(VirtualDevice, FollowsTheClosedForm) {
  VirtualDevice device = device_at_origin();
  device.set_force(Vector3(3.0, 0.0, 0.0));
  const double w = std::sqrt(300.0 / 0.1);
  for (int tick = 1; tick <= 200; ++tick) {
    device.read();
    const double t = tick * 1e-3;
    const double expected = 3.0 / 300.0 * (1.0 - (1.0 + w * t) * std::exp(-w * t));
    EXPECT_NEAR(device.position_m().x(), expected, 0.03 * 3.0 / 300.0) << "tick " << tick;
  }
}

// The hand lags behind a target that accelerates, and is ahead of a target that slows down, by the force of
// its inertia divided by the stiffness, m a / k. It does not ring.
TEST(VirtualDevice, FollowsItsTarget) {
  VirtualDevice device = device_at_origin();
  const double highest_acceleration = 0.02 * 6.0 / (0.5 * 0.5);
  double farthest_off = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double t = std::min(1.0, (tick + 1) / 500.0);
    const double target_m = 0.02 * t * t * (3.0 - 2.0 * t);
    device.set_target(target_at_m(target_m));
    device.read();
    farthest_off = std::max(farthest_off, std::abs(device.position_m().x() - target_m));
  }
  EXPECT_LT(farthest_off, 1.05 * 0.1 * highest_acceleration / 300.0);
  EXPECT_NEAR(device.position_m().x(), 0.02, 1e-12);
}

// Returns the energy that the integrator conserves exactly without damping. The physical energy oscillates
// around it.
double conserved_energy(const VirtualDevice& device, const Hand& hand) {
  const Vector3& x = device.position_m();
  const Vector3& v = device.velocity_m_per_s();
  return 0.5 * hand.mass_kg * v.squaredNorm() + 0.5 * hand.stiffness_n_per_m * x.squaredNorm() -
         0.5 * 1e-3 * hand.stiffness_n_per_m * x.dot(v);
}

// Pushes the handle away, releases it and follows its motion for two seconds. Checks the highest and the last
// energy, relative to the energy at the release.
void expect_no_energy_gained(const Hand& hand) {
  VirtualDevice device = device_at_origin(hand);
  device.set_force(Vector3(3.0, 0.0, 0.0));
  for (int tick = 0; tick < 20; ++tick) device.read();
  device.set_force(Vector3::Zero());
  device.read();
  const double released = conserved_energy(device, hand);
  double highest = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    device.read();
    highest = std::max(highest, conserved_energy(device, hand));
  }
  // With damping, a step at the turning point of the handle may raise this energy by an amount of second
  // order in the length of the step.
  const double step = 1e-6 * hand.stiffness_n_per_m / hand.mass_kg;
  const double allowed = hand.damping_n_s_per_m == 0.0 ? 1e-9 : step;
  EXPECT_LE(highest, released * (1.0 + allowed))
      << hand.mass_kg << " kg, " << hand.stiffness_n_per_m << " N/m, " << hand.damping_n_s_per_m << " N s/m";
  if (hand.damping_n_s_per_m == 0.0) {
    EXPECT_NEAR(conserved_energy(device, hand), released, 1e-9 * released);
  } else {
    EXPECT_LT(conserved_energy(device, hand), released);
  }
}

TEST(VirtualDevice, NeverGainsEnergyFromAHandAtRest) {
  for (const double damping : {0.0, 0.5, 10.954, 1000.0}) {
    for (const double mass : {0.01, 0.1, 10.0}) {
      for (const double stiffness : {1.0, 300.0, 10000.0})
        expect_no_energy_gained({mass, stiffness, damping});
    }
  }
}

TEST(VirtualDevice, LimitsTheForceByItsSize) {
  VirtualDevice device = device_at_origin();
  const double limit = device.specification().maximum_force_n;
  device.set_force(Vector3(300.0, 400.0, 0.0));
  for (int tick = 0; tick < 3000; ++tick) device.read();
  EXPECT_NEAR(device.position_m().norm(), limit / 300.0, 1e-12);
  EXPECT_NEAR(device.position_m().y() / device.position_m().x(), 4.0 / 3.0, 1e-9);
}

TEST(VirtualDevice, TakesAForceThatIsNotFiniteForNone) {
  VirtualDevice device = device_at_origin();
  device.set_force(Vector3(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0));
  EXPECT_EQ(device.read(), DeviceReading{});
  device.set_force(Vector3(std::numeric_limits<double>::infinity(), 0.0, 0.0));
  EXPECT_EQ(device.read(), DeviceReading{});
}

TEST(VirtualDevice, PassesOnOrientationAndButtons) {
  VirtualDevice device = device_at_origin();
  HandTarget target;
  target.pose.orientation = Quaternion(0.0, 1.0, 0.0, 0.0);
  target.buttons = button_main;
  device.set_target(target);
  const DeviceReading reading = *device.read();
  EXPECT_EQ(reading.orientation_e9[0], 1'000'000'000);
  EXPECT_EQ(reading.buttons, button_main);
}

TEST(VirtualDevice, RefusesHandsThatAreNotStable) {
  const auto device = VirtualDevice::make({0.001, 300.0, 10.0}, {});
  ASSERT_FALSE(device.ok());
  EXPECT_EQ(device.error().code, ErrorCode::out_of_range);
  EXPECT_EQ(device.error().field, "mass_kg");
  EXPECT_EQ(VirtualDevice::make({}, target_at_m(std::nan(""))).error().field, "start");
}

}  // namespace
}  // namespace spoonbill
