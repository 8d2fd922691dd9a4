// A device without hardware: a handle of known mass that an imitated hand holds by a spring and damper at a
// target, and that the force pushes. So force is felt and passivity can be tested, and what results is what
// is recorded.
#pragma once

#include "engine/base/result.h"
#include "haptic/device.h"
#include "haptic/hand.h"

namespace spoonbill {

// Pure arithmetic without the mathematics library's functions, so that the same targets and forces give the
// same bits on every machine. Orientation follows the target at once: forces turn nothing.
class VirtualDevice : public Device {
 public:
  // At rest at `start`. Refused: values outside the ranges above.
  static Result<VirtualDevice> make(const Hand& hand, const HandTarget& start);

  static DeviceSpecification default_specification();

  // For the next read().
  void set_target(const HandTarget& target);

  const DeviceSpecification& specification() const override { return specification_; }

  // Moves the handle by one tick (semi-implicit Euler, the damper implicit) and reads it.
  std::optional<DeviceReading> read() override;

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
