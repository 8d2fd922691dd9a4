// A device without hardware: a handle of known mass that an imitated hand holds by a spring and damper at a
// target, and that the force pushes. So force is felt and passivity can be tested, and what results is what
// is recorded.
#pragma once

#include "engine/base/range.h"
#include "engine/base/result.h"
#include "haptic/device.h"

namespace spoonbill {

// A relaxed hand on a stylus. The damping is critical for mass and stiffness, so that the handle neither
// rings nor lags.
struct Hand {
  double mass_kg = 0.1;  // of the handle and what of the hand moves with it
  double stiffness_n_per_m = 300.0;
  double damping_n_s_per_m = 10.954;  // against the target's motion
};

// Within these a step is stable: tick^2 * stiffness / mass stays at most 1.
inline constexpr Range<double> hand_mass_range_kg{0.01, 10.0};
inline constexpr Range<double> hand_stiffness_range_n_per_m{1.0, 10'000.0};
inline constexpr Range<double> hand_damping_range_n_s_per_m{0.0, 1000.0};

Status check_hand(const Hand& hand);

// Where the hand wants the handle, and what its fingers press.
struct HandTarget {
  Pose pose;
  std::uint32_t buttons = 0;
};

// Pure arithmetic without the mathematics library's functions, so that the same targets and forces give the
// same bits on every machine. Orientation follows the target at once: forces turn nothing.
class VirtualDevice : public Device {
 public:
  // At rest at `start`. Refused: values outside the ranges above.
  static Result<VirtualDevice> make(const Hand& hand, const HandTarget& start);

  static DeviceSpecification default_specification();

  // For the next read().
  void set_target(const HandTarget& target);

  const DeviceSpecification& specification() const override;

  // Moves the handle by one tick (semi-implicit Euler, the damper implicit) and reads it.
  DeviceReading read() override;

  // Shortened to the specification's maximum; a force that is not finite counts as none.
  void set_force(const Vector3& force_n) override;

  const Vector3& position_m() const { return position_m_; }
  const Vector3& velocity_m_per_s() const { return velocity_m_per_s_; }

 private:
  VirtualDevice(const Hand& hand, const HandTarget& start);

  Hand hand_;
  DeviceSpecification specification_;
  HandTarget target_;
  Vector3 previous_target_m_;
  Vector3 position_m_;
  Vector3 velocity_m_per_s_ = Vector3::Zero();
  Vector3 force_n_ = Vector3::Zero();
};

}  // namespace spoonbill
