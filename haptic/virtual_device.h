// Devices without hardware: a simulated hand on a virtual handle, steered by targets, and playback of
// recorded readings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "haptic/device.h"
#include "haptic/lock_free.h"

namespace spoonbill {

// A simulated hand on a handle: a mass that a spring and damper pull toward a target. The defaults are a
// relaxed hand on a stylus, critically damped, so that the handle follows fast without ringing.
struct Hand {
  double mass_kg = 0.1;  // the handle and the part of the hand that moves with it
  double stiffness_n_per_m = 300.0;
  double damping_n_s_per_m = 10.954;  // damping of the motion relative to the target
};

// Ranges in which a step is stable: tick_s^2 * stiffness / mass is at most 1.
inline constexpr Range<double> hand_mass_range_kg{0.01, 10.0};
inline constexpr Range<double> hand_stiffness_range_n_per_m{1.0, 10'000.0};
inline constexpr Range<double> hand_damping_range_n_s_per_m{0.0, 1000.0};

// Returns an error that names the first field outside its range.
Status check_hand(const Hand& hand);

// The pose to which the hand moves the handle, and the buttons that it presses.
struct HandTarget {
  Pose pose;
  std::uint32_t buttons = 0;
};

bool is_finite(const HandTarget& target);

// A handle of known mass. A simulated hand pulls it toward a target, and the force of set_force() pushes it.
// Because the force moves the handle, passivity can be tested, and recordings contain the resulting motion.
//
// Uses basic arithmetic only, no functions of the mathematics library, so that the same targets and forces
// give the same bits on every machine. The orientation follows the target at once: forces exert no torque.
class VirtualDevice : public Device {
 public:
  // Makes a device at rest at `start`. Errors: a field of the hand outside its range, a start that is not
  // finite.
  static Result<VirtualDevice> make(const Hand& hand, const HandTarget& start);

  static DeviceSpecification default_specification();

  // Sets the target that the hand follows from the next read() on.
  void set_target(const HandTarget& target);

  const DeviceSpecification& specification() const override { return specification_; }

  // Moves the handle by one tick (semi-implicit Euler with an implicit damper) and reads it.
  std::optional<DeviceReading> read() override;

  // Limits the force to the maximum of the specification. A force that is not finite counts as zero.
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

// A device that returns recorded readings, one per tick, and ignores the force.
class PlaybackDevice : public Device {
 public:
  // The readings must outlive the device.
  PlaybackDevice(DeviceSpecification specification, std::span<const DeviceReading> readings);

  const DeviceSpecification& specification() const override { return specification_; }

  // Returns the next reading. Once all readings have been returned, repeats the last one. Without any
  // readings, returns the default reading.
  std::optional<DeviceReading> read() override;
  void set_force(const Vector3& force_n) override;
  bool is_playback() const override { return true; }

  bool finished() const { return next_ >= readings_.size(); }

 private:
  DeviceSpecification specification_;
  std::span<const DeviceReading> readings_;
  std::size_t next_ = 0;
};

// Passes the newest target from one thread to another without waiting. Intermediate targets are dropped.
class TargetMailbox {
 public:
  explicit TargetMailbox(const HandTarget& start) : targets_(start) {}

  // Sends a target. Called only by the drawing thread.
  void aim(const HandTarget& target) {
    targets_.writing() = target;
    targets_.publish();
  }

  // Returns the newest target, or null if none was sent since the last call. The pointer is valid until the
  // next call. Called only by the haptic thread.
  const HandTarget* receive() { return targets_.update_reading() ? &targets_.reading() : nullptr; }

 private:
  TripleBuffer<HandTarget> targets_;
};

// Interpolates targets that arrive once a frame to one target per tick, so that the hand moves smoothly. A
// new target is reached after as many ticks as have passed since the target before it. At a steady rate of 15
// to 60 frames per second, the hand then neither waits nor jumps.
class TargetFollower {
 public:
  // Number of ticks in which a new target is reached: one frame at 60 and at 15 frames per second.
  static constexpr Range<int> ticks_to_reach{17, 67};

  explicit TargetFollower(const HandTarget& start) : current_(start), final_(start) {}

  // Starts moving toward `target`. A target that is not finite is ignored.
  void aim(const HandTarget& target);

  // Advances by one tick and returns the target of that tick.
  HandTarget step();

 private:
  HandTarget current_;
  HandTarget final_;
  int ticks_left_ = 0;
  int ticks_since_target_ = 0;  // at most ticks_to_reach.high
};

// The virtual device of a live session. Its hand follows targets that another thread sends.
//
//   main thread: InputSource -> HandInputs --aim()--> [ TargetMailbox ] --> haptic thread: SteeredDevice
class SteeredDevice : public Device {
 public:
  // Makes a device at rest at `start`. Errors are those of VirtualDevice::make().
  static Result<std::unique_ptr<SteeredDevice>> make(const Hand& hand, const HandTarget& start);

  // Returns the mailbox for targets. A holder of the pointer may outlive the device.
  const std::shared_ptr<TargetMailbox>& mailbox() const { return mailbox_; }

  const DeviceSpecification& specification() const override { return handle_.specification(); }
  std::optional<DeviceReading> read() override;
  void set_force(const Vector3& force_n) override { handle_.set_force(force_n); }

 private:
  SteeredDevice(VirtualDevice handle, const HandTarget& start);

  VirtualDevice handle_;
  std::shared_ptr<TargetMailbox> mailbox_;
  TargetFollower follower_;
};

// An input that steers the virtual handle, such as a mouse or a SpaceMouse. One owner: the drawing thread.
class InputSource {
 public:
  virtual ~InputSource() = default;

  // Returns true if the person uses the source in this frame. Must be called once per frame, before
  // next_target().
  virtual bool is_used() = 0;

  // Returns the new target of the handle. `current` is the target `elapsed_s` seconds ago. Called only while
  // this source leads the hand.
  virtual HandTarget next_target(const HandTarget& current, double elapsed_s) = 0;
};

// Chooses among input sources: the source used last leads the hand. One owner: the drawing thread.
class HandInputs {
 public:
  // `leader` leads the hand until another source is used. Every source must outlive its last update().
  HandInputs(std::shared_ptr<TargetMailbox> mailbox, const HandTarget& start, const InputSource& leader)
      : mailbox_(std::move(mailbox)), target_(start), leader_(&leader) {}

  // Makes the source the leader if it is in use. Sends the source's target to the device if the source leads
  // the hand.
  void update(InputSource& source, double elapsed_s) {
    if (source.is_used()) leader_ = &source;
    if (leader_ != &source) return;
    target_ = source.next_target(target_, elapsed_s);
    mailbox_->aim(target_);
  }

 private:
  std::shared_ptr<TargetMailbox> mailbox_;
  HandTarget target_;
  const InputSource* leader_;
};

}  // namespace spoonbill
