// The interface of haptic devices: a device reports the pose of the hand and applies a force to the hand.
//
// A device has one owner: the thread of a live session that runs the ticks, or the loop that replays or
// records without a window. Coordinates have x right, y up and z toward the person, in metres; forces are in
// newtons.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// The capabilities of a device. All force limits come from here.
struct DeviceSpecification {
  std::string name;
  double maximum_force_n = 3.3;
  double maximum_stiffness_n_per_m = 700.0;
  double maximum_damping_n_s_per_m = 5.0;
  double workspace_radius_m = 0.15;
  double position_resolution_m = 1e-9;
  bool senses_orientation = true;
  bool actuates_torque = false;

  // True for a device without physical bounds: a live session centres and sizes the workspace on the model.
  // The flag is not recorded, because recordings contain the resulting poses.
  bool workspace_follows_model = false;

  // Limits of the safety chain (haptic/safe_device.h).
  double quiet_force_n = 0.2;  // the force stays off until 10 ticks in a row request less than this
  // Time for the force to ramp from zero to full. The short default suits the virtual device, which cannot
  // hurt anybody; use 2 s for real hardware.
  double ramp_time_s = 0.2;
  // Limit on the rate of change of the force. A hand at maximum speed and maximum stiffness changes the force
  // by 700 N/s, so the limit affects only jumps.
  double maximum_force_rate_n_per_s = 1000.0;
  double maximum_speed_m_per_s = 1.0;  // the force fades above this speed and is zero at twice the speed
  std::uint32_t dead_man_buttons = 0;  // buttons that must all be pressed for any force; 0: none
};

inline constexpr Range<double> device_force_range_n{0.0, 1000.0};
inline constexpr Range<double> device_stiffness_range_n_per_m{0.0, 1e6};
inline constexpr Range<double> device_damping_range_n_s_per_m{0.0, 1e5};
inline constexpr Range<double> device_workspace_range_m{1e-3, 10.0};
inline constexpr Range<double> device_resolution_range_m{0.0, 0.1};
inline constexpr Range<double> device_quiet_force_range_n{1e-3, 1000.0};
inline constexpr Range<double> device_ramp_time_range_s{0.0, 60.0};
inline constexpr Range<double> device_force_rate_range_n_per_s{1.0, 1e6};
inline constexpr Range<double> device_speed_range_m_per_s{1e-2, 100.0};

// Returns an error that names the first field outside its range.
Status check_specification(const DeviceSpecification& specification);

inline constexpr std::uint32_t button_main = 1u;   // pressed: the tool grips the material and can pull it
inline constexpr std::uint32_t button_hover = 2u;  // set: the tool moves with the hand but touches nothing

// Largest valid coordinate of a reading, farther from the origin than any device reaches.
inline constexpr std::int64_t reading_limit_nm = 10'000'000'000;

// One reading of a device. Positions are whole nanometres and orientations whole billionths, so that a
// recording stores exactly the input of each tick.
struct DeviceReading {
  std::int64_t position_nm[3] = {0, 0, 0};
  std::int64_t orientation_e9[4] = {0, 0, 0, 1'000'000'000};  // x, y, z, w
  std::uint32_t buttons = 0;  // button_main, button_hover, and buttons specific to the device
  // Number of ticks that the loop missed before this reading. Set by SafeDevice, not by devices.
  std::uint32_t missed = 0;

  // Returns true if every coordinate is within reading_limit_nm and the orientation is a unit quaternion.
  // Only valid readings may reach the simulation or a recording.
  bool is_valid() const;
  bool has_unit_orientation() const;

  // Returns the pose with a normalised orientation. The orientation is the identity if the quaternion is
  // zero.
  Pose pose() const;

  // Rounds a pose to the nearest reading and clamps coordinates to reading_limit_nm. A pose that is not
  // finite or has a degenerate quaternion gives an invalid reading, which SafeDevice treats as a fault.
  static DeviceReading from(const Pose& pose, std::uint32_t buttons);

  friend bool operator==(const DeviceReading&, const DeviceReading&) = default;
};

// A haptic device, or a simulated substitute for a haptic device.
//
// A derived class for real hardware has a factory function, which opens the device on a thread that may
// block. If the device cannot be opened, the returned Error states what is missing. The destructor closes the
// device.
//
// read() and set_force() must not allocate, lock, block or throw. The ticking thread calls them; the owner of
// the device may call them before that thread starts and after it has ended. The watchdog
// (haptic/watched_device.h) sets zero force from its own thread. No two threads call these functions at the
// same time. A driver with a callback thread or a socket exchanges readings and forces through a
// TripleBuffer, and drops a force that is not renewed within 50 ms.
//
// A force other than zero comes only from SafeDevice (haptic/safe_device.h).
class Device {
 public:
  virtual ~Device() = default;

  // Returns the specification, which passes check_specification() and does not change during the life of the
  // device.
  virtual const DeviceSpecification& specification() const = 0;

  // Returns the reading for this tick; called once per tick. Returns nothing if there is no current reading:
  // the device is disconnected, has stopped itself or answers too late. The device may recover.
  virtual std::optional<DeviceReading> read() = 0;

  // Sets the force on the hand until the next tick. The force is at most the maximum of the specification.
  virtual void set_force(const Vector3& force_n) = 0;

  // Returns true for a device that plays back recorded readings. The readings were checked when they were
  // recorded, and they reach the simulation unchanged. The recording also contains the proxy resets that
  // faults caused.
  virtual bool is_playback() const { return false; }
};

}  // namespace spoonbill
