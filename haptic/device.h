// The device interface: where the hand is, and the force it is given. One owner: the live session's haptic
// side, or whoever runs the lock-step loop. Frame: x right, y up, z toward the person, metres, newtons.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// What a device can do; every limit of the force comes from here.
struct DeviceSpecification {
  std::string name;
  double maximum_force_n = 3.3;
  double maximum_stiffness_n_per_m = 700.0;
  double maximum_damping_n_s_per_m = 5.0;
  double workspace_radius_m = 0.15;
  double position_resolution_m = 1e-9;
  bool senses_orientation = true;
  bool actuates_torque = false;

  // No hardware bounds the workspace: a live session centres it on the model and makes it reach as far. Not
  // recorded, as what it led to is.
  bool workspace_follows_model = false;

  // What the safety chain (haptic/safety.h) keeps to.
  double quiet_force_n = 0.2;  // forces begin when what is wanted has stayed below this
  // From no force to the whole of it. Short, as the virtual device hurts nobody; 2 s suits a real one.
  double ramp_time_s = 0.2;
  // What a hand at the highest speed asks of the highest stiffness is less (700 N/s), so that only jumps are
  // held back.
  double maximum_force_rate_n_per_s = 1000.0;
  double maximum_speed_m_per_s = 1.0;  // faster hands get less force, none at twice this
  std::uint32_t dead_man_buttons = 0;  // all of these must be held for any force; 0: none
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

// Names the first field that is outside its range.
Status check_specification(const DeviceSpecification& specification);

inline constexpr std::uint32_t button_main = 1u;  // grips in pull
inline constexpr std::uint32_t button_hover =
    2u;  // a hand that only points, as a mouse does: nothing is touched

// Farther from the origin than any device reaches.
inline constexpr std::int64_t reading_limit_nm = 10'000'000'000;

// One reading. Positions are whole nanometres and orientations whole billionths, so that a recording holds
// exactly what the tick was given.
struct DeviceReading {
  std::int64_t position_nm[3] = {0, 0, 0};
  std::int64_t orientation_e9[4] = {0, 0, 0, 1'000'000'000};  // x, y, z, w
  std::uint32_t buttons = 0;

  // Whether it may reach the simulation and a recording: within 10 m of the origin on each axis, the
  // orientation a unit quaternion.
  bool is_valid() const;
  bool has_unit_orientation() const;

  // With the orientation brought back to unit length, or none where all four are zero.
  Pose pose() const;

  // Rounded to the nearest; a coordinate beyond 10 m stops there. What is not finite becomes 0, and a
  // quaternion without a direction the identity: a driver's garbage must not reach the simulation.
  static DeviceReading from(const Pose& pose, std::uint32_t buttons);

  friend bool operator==(const DeviceReading&, const DeviceReading&) = default;
};

// A haptic device, or what takes the place of one.
//
// A factory of each class opens it, on a thread that may wait, and returns an Error that says what is
// missing; the destructor closes it. read() and set_force() are called by the thread that ticks, or before
// that thread starts and after it has ended by its owner: they neither allocate, lock, wait nor throw. A
// driver that calls back on a thread of its own, or answers through a socket, hands readings and forces over
// through a TripleBuffer, and lets a force lapse that is not repeated within 50 ms.
//
// Only SafeDevice (haptic/safe_device.h) calls set_force().
class Device {
 public:
  virtual ~Device() = default;

  // Constant while the device lives; passes check_specification().
  virtual const DeviceSpecification& specification() const = 0;

  // The reading for this tick; called once a tick. Nothing where there is none that is current: the device is
  // disconnected, has stopped itself or answers too late. It may come back.
  virtual std::optional<DeviceReading> read() = 0;

  // The force on the hand until the next tick. Never above the specification's maximum.
  virtual void set_force(const Vector3& force_n) = 0;
};

}  // namespace spoonbill
