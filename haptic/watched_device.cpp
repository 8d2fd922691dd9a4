#include "haptic/watched_device.h"

#include <string>
#include <system_error>

#include "haptic/haptic_loop.h"

namespace spoonbill {
namespace {

constexpr std::int64_t check_interval_ns = 1'000'000;

}  // namespace

std::optional<DeviceReading> WatchedDevice::read() {
  const Claim claim(busy_);
  if (!claim) return {};
  return device_->read();
}

void WatchedDevice::set_force(const Vector3& force_n) {
  const Claim claim(busy_);
  if (!claim) return;  // the watchdog is writing zero
  forces_.fetch_add(1, std::memory_order_acq_rel);
  device_->set_force(cut_.load(std::memory_order_acquire) ? Vector3::Zero() : force_n);
}

void WatchedDevice::check(std::int64_t now_ns) {
  const std::uint64_t forces = forces_.load(std::memory_order_acquire);
  if (forces != seen_forces_) {
    seen_forces_ = forces;
    seen_ns_ = now_ns;
    is_zeroed_ = false;
    return;
  }
  if (forces == 0 || is_zeroed_ || now_ns - seen_ns_ < watchdog_limit_ns) return;
  const Claim claim(busy_);
  // If the haptic thread is using the device, the next check sees whether it has set a force.
  if (!claim || forces_.load(std::memory_order_acquire) != forces) return;
  cut_.store(true, std::memory_order_release);
  device_->set_force(Vector3::Zero());
  is_zeroed_ = true;
}

Status WatchedDevice::start(bool real_time) {
  try {
    thread_ = std::thread([this] {
      while (!stopping_.load(std::memory_order_acquire)) {
        sleep_until_ns(boot_time_ns() + check_interval_ns);
        check(boot_time_ns());
      }
    });
  } catch (const std::system_error& problem) {
    return Error{ErrorCode::unavailable,
                 std::string("the watchdog of the device cannot be started: ") + problem.what()};
  }
  if (real_time) make_ahead_of_haptic_thread(thread_);
  return {};
}

void WatchedDevice::stop() {
  stopping_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
}

}  // namespace spoonbill
