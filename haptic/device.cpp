#include "haptic/device.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace spoonbill {

namespace {

constexpr double nanometres_per_metre = 1e9;
constexpr double billion = 1e9;

// Smallest squared length of a quaternion that can be normalised.
constexpr double smallest_square = 1e-12;

// Tolerance for the squared length of a unit quaternion. Rounding to billionths changes it by at most 2e-9.
constexpr double unit_square_tolerance = 1e-6;

// Rounds a coordinate to whole nanometres, at most reading_limit_nm from zero. A coordinate that is not
// finite becomes an invalid coordinate.
std::int64_t whole_nanometres(double metres) {
  if (!std::isfinite(metres)) return reading_limit_nm + 1;
  const double limit = static_cast<double>(reading_limit_nm);
  return static_cast<std::int64_t>(std::round(std::clamp(metres * nanometres_per_metre, -limit, limit)));
}

}  // namespace

Status check_specification(const DeviceSpecification& specification) {
  struct Field {
    const char* name;
    double value;
    Range<double> range;
  };
  const Field fields[] = {
      {"maximum_force_n", specification.maximum_force_n, device_force_range_n},
      {"maximum_stiffness_n_per_m", specification.maximum_stiffness_n_per_m, device_stiffness_range_n_per_m},
      {"maximum_damping_n_s_per_m", specification.maximum_damping_n_s_per_m, device_damping_range_n_s_per_m},
      {"workspace_radius_m", specification.workspace_radius_m, device_workspace_range_m},
      {"position_resolution_m", specification.position_resolution_m, device_resolution_range_m},
      {"quiet_force_n", specification.quiet_force_n, device_quiet_force_range_n},
      {"ramp_time_s", specification.ramp_time_s, device_ramp_time_range_s},
      {"maximum_force_rate_n_per_s", specification.maximum_force_rate_n_per_s,
       device_force_rate_range_n_per_s},
      {"maximum_speed_m_per_s", specification.maximum_speed_m_per_s, device_speed_range_m_per_s}};
  for (const Field& field : fields) {
    if (Status status = check_range(field.name, field.value, field.range); !status.ok()) {
      return status.error().in("device " + specification.name);
    }
  }
  return {};
}

bool DeviceReading::is_valid() const {
  for (const std::int64_t coordinate : position_nm) {
    if (coordinate > reading_limit_nm || coordinate < -reading_limit_nm) return false;
  }
  for (const std::int64_t part : orientation_e9) {
    if (part > 1'000'000'000 || part < -1'000'000'000) return false;
  }
  return has_unit_orientation();
}

bool DeviceReading::has_unit_orientation() const {
  double square = 0.0;
  for (const std::int64_t part : orientation_e9) {
    const double q = static_cast<double>(part) / billion;
    square += q * q;
  }
  return std::abs(square - 1.0) <= unit_square_tolerance;
}

Pose DeviceReading::pose() const {
  Pose pose;
  for (int axis = 0; axis < 3; ++axis) {
    pose.position_m[axis] = static_cast<double>(position_nm[axis]) / nanometres_per_metre;
  }
  Eigen::Vector4d q;
  for (int k = 0; k < 4; ++k) q[k] = static_cast<double>(orientation_e9[k]) / billion;
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (square < smallest_square) return pose;
  const double length = std::sqrt(square);
  pose.orientation = Quaternion(q[3] / length, q[0] / length, q[1] / length, q[2] / length);
  return pose;
}

DeviceReading DeviceReading::from(const Pose& pose, std::uint32_t buttons) {
  DeviceReading reading;
  reading.buttons = buttons;
  for (int axis = 0; axis < 3; ++axis) reading.position_nm[axis] = whole_nanometres(pose.position_m[axis]);
  const double q[4] = {pose.orientation.x(), pose.orientation.y(), pose.orientation.z(),
                       pose.orientation.w()};
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!std::isfinite(square) || square < smallest_square) {
    std::fill(std::begin(reading.orientation_e9), std::end(reading.orientation_e9), 0);
    return reading;
  }
  const double length = std::sqrt(square);
  for (int k = 0; k < 4; ++k) {
    reading.orientation_e9[k] = static_cast<std::int64_t>(std::round(q[k] / length * billion));
  }
  return reading;
}

}  // namespace spoonbill
