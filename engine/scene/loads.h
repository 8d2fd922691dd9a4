// What loads a body and what holds it. Plain data; directions are the world's, regions the body's own.
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/body_region.h"

namespace spoonbill {

// Pushes the surface inwards, and follows it as it deforms; below zero it pulls.
struct PressureLoad {
  BodyRegion region;
  double pressure_pa = 0.0;
};

enum class ForceShare { surface, volume };

// One force over all of a region: by the area of its surface, or by its volume.
struct ForceLoad {
  BodyRegion region;
  Vector3 force_n = Vector3::Zero();
  ForceShare shared_by = ForceShare::surface;
};

// On a point of the surface, in the knot domain.
struct PointLoad {
  double u = 0.0, v = 0.0;
  Vector3 force_n = Vector3::Zero();
};

using Load = std::variant<PressureLoad, ForceLoad, PointLoad>;

enum class MotionKind { ramp, oscillation };

// From the first tick on, in the time of the hand: a tick is a millisecond of it whatever the iterations.
//
// A ramp goes the way once, without a jerk: at t = time / duration, 10 t^3 - 15 t^4 + 6 t^5 of it, of which
// speed and acceleration are zero at both ends. An oscillation is a sine to both sides of where it began,
// which grows in the same manner over its first period.
struct SupportMotion {
  MotionKind kind = MotionKind::ramp;
  Vector3 way_m = Vector3::Zero();  // of a ramp; of an oscillation, to one side
  double duration_s = 1.0;          // of a ramp
  double frequency_hz = 1.0;        // of an oscillation
};

// Holds the nodes of a region where they are, or moves them. What a fixing plane holds stays; of what two
// supports would hold, the later one has it.
struct Support {
  BodyRegion region;
  std::optional<SupportMotion> motion = {};
};

// A rigid half-space that nothing moves, on which bodies lie; soft tools do not meet it.
struct Ground {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitY();  // unit, outward
  double friction = 0.5;              // the smoother of ground and body counts
};

// How far a motion is, and the most that it ever moves in a second.
Vector3 way_at(const SupportMotion& motion, double time_s);
double top_speed_m_per_s(const SupportMotion& motion);

inline constexpr Range<int> load_count_range{0, 64};  // of a body
inline constexpr Range<int> support_count_range{0, 64};
inline constexpr Range<double> pressure_range_pa{-1e9, 1e9};
inline constexpr double force_limit_n = 1e6;  // of the vector's length
inline constexpr double way_limit_m = 1.0;    // of the vector's length
inline constexpr Range<double> motion_duration_range_s{0.01, 3600.0};
inline constexpr Range<double> motion_frequency_range_hz{0.01, 100.0};
inline constexpr double motion_speed_limit_m_per_s = 5.0;
inline constexpr Range<double> ground_friction_range{0.0, 5.0};

// Each after the region that it acts on, but for the point's.
template <>
inline constexpr const char* kind_name<PressureLoad> = "pressure";
template <>
inline constexpr auto fields_of<PressureLoad> = std::to_array<Field<PressureLoad>>({
    number_field("pressure_pa", &PressureLoad::pressure_pa, pressure_range_pa, FieldUnit::pascal),
});

inline constexpr const char* force_share_names[] = {"surface", "volume"};
template <>
inline constexpr const char* kind_name<ForceLoad> = "force";
template <>
inline constexpr auto fields_of<ForceLoad> = std::to_array<Field<ForceLoad>>({
    vector_field("force_n", &ForceLoad::force_n, force_limit_n, FieldUnit::newton),
    choice_field<&ForceLoad::shared_by>("shared_by", force_share_names),
});

// Files keep u and v within the domain of the body's surface.
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
    vector_field("way_mm", &SupportMotion::way_m, way_limit_m, FieldUnit::metre),
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

// Each names the field, the value and the range of the first thing that is not within it.
Status check_load(const Load& load);
Status check_support(const Support& support);
Status check_ground(const Ground& ground);

}  // namespace spoonbill
