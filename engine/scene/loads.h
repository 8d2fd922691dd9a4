// Loads, supports, fixing planes and the ground. Plain data; vectors are in world axes, regions in the body's
// own coordinates.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Plane that fixes every node behind it, on the side opposite to the normal.
struct FixingPlane {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitX();  // unit normal; points away from the fixed side
};

template <>
inline constexpr auto fields_of<FixingPlane> = std::to_array<Field<FixingPlane>>({
    position_field("point_mm", &FixingPlane::point_m),
    direction_field("normal", &FixingPlane::normal),
});

// Pressure on the surface of a region. A positive pressure pushes inwards, a negative one pulls outwards. The
// direction and area of the load follow the deformation of the surface.
struct PressureLoad {
  BodyRegion region;
  double pressure_pa = 0.0;
};

enum class ForceDistribution { surface, volume };

// Total force on a region, distributed by surface area or by volume.
struct ForceLoad {
  BodyRegion region;
  Vector3 force_n = Vector3::Zero();
  ForceDistribution distributed_by = ForceDistribution::surface;
};

// Force on the surface point with the parameters (u, v).
struct PointLoad {
  double u = 0.0, v = 0.0;
  Vector3 force_n = Vector3::Zero();
};

using Load = std::variant<PressureLoad, ForceLoad, PointLoad>;

enum class MotionKind { ramp, oscillation };

// Prescribed motion of a support, starting at the first tick. One tick is one millisecond.
//
// A ramp moves once by the displacement. The fraction covered at t = time / duration is 10 t^3 - 15 t^4 + 6
// t^5, so that speed and acceleration vanish at both ends. An oscillation is a sine about the initial
// position; its amplitude grows by the same polynomial over the first period.
struct SupportMotion {
  MotionKind kind = MotionKind::ramp;
  // Whole displacement of a ramp, or amplitude of an oscillation.
  Vector3 displacement_m = Vector3::Zero();
  double duration_s = 1.0;    // duration of a ramp; ignored for an oscillation
  double frequency_hz = 1.0;  // frequency of an oscillation; ignored for a ramp
};

// Fixes the nodes of a region, or moves them if a motion is given. Fixing planes take precedence over
// supports, and later supports over earlier ones.
struct Support {
  BodyRegion region;
  std::optional<SupportMotion> motion = {};
};

// Rigid, immovable half-space on which bodies rest. Soft tools do not touch it.
struct Ground {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitY();  // unit normal; points out of the ground
  double friction = 0.5;              // the smaller of the friction coefficients of ground and body applies
};

// Returns the height of a ground that is level within 0.8 degrees; empty for another one and for none.
inline std::optional<double> level_height_m(const std::optional<Ground>& ground) {
  if (!ground || ground->normal.y() <= 0.9999) return std::nullopt;
  return ground->point_m.y();
}

// Returns the displacement of a moving support at `time_s`, which must not be negative.
Vector3 displacement_at(const SupportMotion& motion, double time_s);
// Returns the highest speed of a motion.
double top_speed_m_per_s(const SupportMotion& motion);

inline constexpr Range<int> fixing_plane_count_range{0, 64};
inline constexpr Range<int> load_count_range{0, 64};     // number of loads of one body
inline constexpr Range<int> support_count_range{0, 64};  // number of supports of one body
inline constexpr Range<double> pressure_range_pa{-1e9, 1e9};
inline constexpr double force_limit_n = 1e6;         // largest length of a force vector
inline constexpr double displacement_limit_m = 1.0;  // largest length of a displacement vector
inline constexpr Range<double> motion_duration_range_s{0.01, 3600.0};
inline constexpr Range<double> motion_frequency_range_hz{0.01, 100.0};
inline constexpr double motion_speed_limit_m_per_s = 5.0;
inline constexpr Range<double> ground_friction_range{0.0, 5.0};

// Name and fields of a pressure load in files. Files store the load's region before these fields.
template <>
inline constexpr const char* kind_name<PressureLoad> = "pressure";
template <>
inline constexpr auto fields_of<PressureLoad> = std::to_array<Field<PressureLoad>>({
    number_field("pressure_pa", &PressureLoad::pressure_pa, pressure_range_pa, FieldUnit::pascal),
});

inline constexpr const char* force_distribution_names[] = {"surface", "volume"};
// Name and fields of a force load in files. Files store the load's region before these fields.
template <>
inline constexpr const char* kind_name<ForceLoad> = "force";
template <>
inline constexpr auto fields_of<ForceLoad> = std::to_array<Field<ForceLoad>>({
    vector_field("force_n", &ForceLoad::force_n, force_limit_n, FieldUnit::newton),
    choice_field<&ForceLoad::distributed_by>("shared_by", force_distribution_names),
});

// The table of a point load sets no limits for u and v. check_loads() checks that they are in the domain of
// the body's surface.
template <>
inline constexpr const char* kind_name<PointLoad> = "point";
template <>
inline constexpr auto fields_of<PointLoad> = std::to_array<Field<PointLoad>>({
    number_field("u", &PointLoad::u, {-unlimited, unlimited}),
    number_field("v", &PointLoad::v, {-unlimited, unlimited}),
    vector_field("force_n", &PointLoad::force_n, force_limit_n, FieldUnit::newton),
});

inline constexpr const char* motion_kind_names[] = {"ramp", "oscillation"};
template <>
inline constexpr auto fields_of<SupportMotion> = std::to_array<Field<SupportMotion>>({
    choice_field<&SupportMotion::kind>("kind", motion_kind_names),
    vector_field("way_mm", &SupportMotion::displacement_m, displacement_limit_m, FieldUnit::metre),
    number_field("duration_s", &SupportMotion::duration_s, motion_duration_range_s, FieldUnit::second)
        .only_if([](const SupportMotion& motion) { return motion.kind == MotionKind::ramp; }),
    number_field("frequency_hz", &SupportMotion::frequency_hz, motion_frequency_range_hz, FieldUnit::hertz)
        .only_if([](const SupportMotion& motion) { return motion.kind == MotionKind::oscillation; }),
});

template <>
inline constexpr auto fields_of<Ground> = std::to_array<Field<Ground>>({
    position_field("point_mm", &Ground::point_m),
    direction_field("normal", &Ground::normal),
    number_field("friction", &Ground::friction, ground_friction_range),
});

// Returns an error that names the first field out of range, with its value and its range.
Status check_fixing_plane(const FixingPlane& plane);
Status check_load(const Load& load);  // does not check u and v of a point load: see check_loads()
Status check_support(const Support& support);
Status check_ground(const Ground& ground);

}  // namespace spoonbill
