// A watchdog between the haptic loop and a device: a force that the loop does not renew for 10 ms becomes
// zero.
//
//   haptic thread:  SafeDevice -> WatchedDevice -> device
//   own thread:     WatchedDevice::check() every millisecond
//
// The loop may be stuck in a tick, starved of its processor, or stopped. While the machine is suspended, the
// device also keeps the last force; the first check after the resume sets it to zero.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

#include "haptic/device.h"

namespace spoonbill {

// Time without a call of set_force() after which the watchdog sets the force to zero.
inline constexpr std::int64_t watchdog_limit_ns = 10'000'000;

// A device behind the watchdog. Its Device functions are called by the haptic thread, which never waits and
// reads no clock; check() is called by the watchdog's thread. Only one of the two threads uses the device at
// a time. While the watchdog writes zero, the haptic thread reads nothing and its force is dropped. If a
// driver blocks in one of its functions, the force cannot be cut.
class WatchedDevice : public Device {
 public:
  // The device must outlive this object. No thread runs until start().
  explicit WatchedDevice(Device& device) : device_(&device) {}
  ~WatchedDevice() override { stop(); }
  WatchedDevice(const WatchedDevice&) = delete;
  WatchedDevice& operator=(const WatchedDevice&) = delete;

  const DeviceSpecification& specification() const override { return device_->specification(); }
  std::optional<DeviceReading> read() override;
  // After the watchdog has cut the force, only zero passes until consume_cut() is called.
  void set_force(const Vector3& force_n) override;
  bool is_playback() const override { return device_->is_playback(); }

  // Returns whether the watchdog has cut the force since the last call. Called by the haptic thread at the
  // start of a tick. If true, the tick must treat the time since the previous tick as a stall.
  bool consume_cut() { return cut_.exchange(false, std::memory_order_acq_rel); }

  // Writes zero if no force has been set for watchdog_limit_ns. The time counts from the first call of this
  // function after the last force. `now_ns` is from any clock that never goes back and also runs while the
  // machine is suspended.
  void check(std::int64_t now_ns);

  // Starts a thread that calls check() every millisecond. If `real_time`, requests a higher priority than
  // that of the haptic thread. Returns an error if the thread cannot be started.
  Status start(bool real_time);
  void stop();

 private:
  // Claims exclusive use of the device until destruction. Converts to false if the other thread is using the
  // device.
  class Claim {
   public:
    explicit Claim(std::atomic<bool>& busy)
        : busy_(busy), is_held_(!busy.exchange(true, std::memory_order_acq_rel)) {}
    ~Claim() {
      if (is_held_) busy_.store(false, std::memory_order_release);
    }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    explicit operator bool() const { return is_held_; }

   private:
    std::atomic<bool>& busy_;
    bool is_held_;
  };

  Device* device_;
  std::atomic<bool> busy_{false};
  std::atomic<std::uint64_t> forces_{0};  // number of set_force() calls
  std::atomic<bool> cut_{false};

  // Used by check() only.
  std::uint64_t seen_forces_ = 0;
  std::int64_t seen_ns_ = 0;  // time of the first check after the last force
  bool is_zeroed_ = false;    // whether zero was written after the last force

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace spoonbill
