// Tests the guidance of a hand: its force, and that it never gives a hand energy.
#include "app/training/guidance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "app/training/exact_angles.h"
#include "haptic/tick.h"
#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

// A path with a sharp corner, about which the nearest point jumps from one side to the other.
const std::vector<Vector3> bent_path_m = {Vector3::Zero(), Vector3(0.06, 0.12, 0.0), Vector3(0.08, 0.0, 0.0)};

TEST(Guidance, PullsToTheNearestPointOfThePath) {
  const Guidance guidance(bent_path_m, 0.5);
  EXPECT_EQ(guidance.force_n(Vector3(0.03, 0.06, 0.0)).norm(), 0.0);  // on the path
  const Vector3 beside = guidance.force_n(Vector3(0.03, 0.06, 0.002));
  EXPECT_NEAR(beside.z(), -0.5 * Guidance::stiffness_n_per_m * 0.002, 1e-12);
  EXPECT_NEAR(guidance.force_n(Vector3(-0.3, -0.2, 0.3)).norm(), 0.5 * Guidance::largest_force_n, 1e-12);
  EXPECT_EQ(Guidance().force_n(Vector3(1.0, 0.0, 0.0)).norm(), 0.0);
  EXPECT_EQ(Guidance(bent_path_m, 0.0).force_n(Vector3(1.0, 0.0, 0.0)).norm(), 0.0);
}

TEST(Guidance, NearestPointOfOnePointOrAPathOfNoLengthIsThatPoint) {
  const Vector3 point_m(0.1, 0.2, 0.3);
  EXPECT_EQ(find_nearest_on_path({point_m}, Vector3::Zero()), point_m);
  EXPECT_EQ(find_nearest_on_path({point_m, point_m}, Vector3::Zero()), point_m);
}

// A hand on the virtual handle follows random targets about a path. The device feels the guidance alone.
struct GuidedHand {
  double given_j = 0.0;       // energy that the force has given to the hand so far
  double most_given_j = 0.0;  // largest value of it
  double largest_force_n = 0.0;
};

// Returns where the hand wants the handle at a tick.
using TargetAt = std::function<Vector3(int tick)>;

// `missed` is the number of ticks that are missed after each one.
GuidedHand guide_hand(const TargetAt& target_at, std::uint32_t missed) {
  const Guidance guidance(bent_path_m, 1.0);
  VirtualDevice handle = VirtualDevice::make(Hand{}, {}).value();
  const DeviceSpecification device = handle.specification();
  CouplingState coupling;
  GuidedHand hand;
  Vector3 before_m = Vector3::Zero(), force_n = Vector3::Zero();
  for (int tick = 0; tick < 20'000; ++tick) {
    handle.set_target({{target_at(tick), Quaternion::Identity()}, 0});
    // The handle moves under a force that is held for all ticks that are missed.
    for (std::uint32_t k = 0; k <= missed; ++k) handle.read();
    const Vector3 position_m = handle.position_m();
    hand.given_j += force_n.dot(position_m - before_m);
    hand.most_given_j = std::max(hand.most_given_j, hand.given_j);
    before_m = position_m;
    const Vector3 guided_m = guidance.force_n(position_m) / device.maximum_stiffness_n_per_m;
    force_n = couple(coupling, device, position_m, guided_m, missed).force_n;
    handle.set_force(force_n);
    hand.largest_force_n = std::max(hand.largest_force_n, force_n.norm());
  }
  return hand;
}

void expect_passive(const GuidedHand& hand) {
  constexpr double rounding_j = 1e-9;  // the hand does some 0.1 J of work
  EXPECT_LT(hand.most_given_j, rounding_j);
  EXPECT_LT(hand.given_j, 0.0);  // damping takes energy out
  EXPECT_LT(hand.largest_force_n, VirtualDevice::default_specification().maximum_force_n);
}

TEST(Guidance, NeverGivesAHandMoreEnergyThanItTook) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    for (const std::uint32_t missed : {0u, 2u}) {
      std::mt19937 random(seed);
      const auto draw = [&] { return 2.0 * random() / std::mt19937::max() - 1.0; };
      Vector3 target_m = Vector3::Zero();
      const GuidedHand hand = guide_hand(
          [&](int tick) {
            if (tick % 150 == 0) target_m = 0.1 * Vector3(draw(), draw(), draw());
            return target_m;
          },
          missed);
      expect_passive(hand);
      if (missed == 0) {
        EXPECT_GT(hand.largest_force_n, 0.5 * Guidance::largest_force_n);
      }
    }
  }
}

// A force that is not a gradient would give energy in one of the two senses, lap after lap.
TEST(Guidance, GivesNoEnergyToAHandThatCirclesThePath) {
  for (const double sense : {-1.0, 1.0}) {
    for (const Vector3& across : {Vector3(Vector3::UnitY()), Vector3(Vector3::UnitZ())}) {
      expect_passive(guide_hand(
          [&](int tick) {
            constexpr int lap_ticks = 4000;
            const double part = static_cast<double>(tick % lap_ticks) / lap_ticks - 0.5;
            const SineCosine turn = sine_cosine(sense * 2.0 * std::numbers::pi * part);
            const Vector3 side_m = 0.04 * (turn.cosine * across + turn.sine * Vector3::UnitX());
            return Vector3(bent_path_m[1] + side_m);
          },
          0));
    }
  }
}

}  // namespace
}  // namespace spoonbill
