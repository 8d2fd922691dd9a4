// A device that returns recorded readings, one a tick, whatever force it is given.
#pragma once

#include <cstddef>
#include <span>

#include "haptic/device.h"

namespace spoonbill {

class PlaybackDevice : public Device {
 public:
  // The readings must outlive the device.
  PlaybackDevice(DeviceSpecification specification, std::span<const DeviceReading> readings);

  const DeviceSpecification& specification() const override { return specification_; }

  // After the last reading: that one again (the default reading where there was none).
  std::optional<DeviceReading> read() override;
  void set_force(const Vector3& force_n) override;

  bool finished() const { return next_ >= readings_.size(); }

 private:
  DeviceSpecification specification_;
  std::span<const DeviceReading> readings_;
  std::size_t next_ = 0;
};

}  // namespace spoonbill
