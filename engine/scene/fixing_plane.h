// Planes that hold what is behind them.
#pragma once

#include "engine/base/field.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Every node on its far side (opposite to the normal) is held.
struct FixingPlane {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitX();  // unit
};

template <>
inline constexpr auto fields_of<FixingPlane> = std::to_array<Field<FixingPlane>>({
    position_field("point_mm", &FixingPlane::point_m),
    direction_field("normal", &FixingPlane::normal),
});

// Names the field, the value and the range of the first thing that is not within it.
Status check_fixing_plane(const FixingPlane& plane);

}  // namespace spoonbill
