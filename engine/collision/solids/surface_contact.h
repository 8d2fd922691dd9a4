// A contact of a tool with a surface: where on it, in which frame, how deep.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/collision/levels/parameter_range.h"
#include "engine/collision/solids/solid_polish.h"

namespace spoonbill {

// Unit, spanning the plane across a unit normal: along du as far as it lies in it, and normal x u. Where du
// vanishes, as at a pole, both are chosen by dv or, where that vanishes too, by the normal alone.
struct Tangents {
  Vector3 u = Vector3::UnitX(), v = Vector3::UnitZ();
};
Tangents tangents_across(const Vector3& normal, const SurfacePoint& at);

struct SurfaceContact {
  double u = 0.0, v = 0.0;
  Vector3 point_m = Vector3::Zero();  // on the surface
  Vector3 normal = Vector3::UnitY();  // unit, along du x dv
  double depth_m = 0.0;               // of the tool in the surface's inside; negative where they are apart
  Vector3 tangent_u = Vector3::UnitX(), tangent_v = Vector3::UnitZ();  // tangents_across() the normal
};

// A part of the surface that a tool touches and that hangs together.
struct ToolContactRegion {
  ParameterRange range;  // all of it is within
  SurfaceContact deepest;
};

inline constexpr int tool_region_capacity = 64;

// The frame at a spot, its depth that of the distance.
SurfaceContact contact_at(const Surface& surface, const SurfaceSpot& spot);

}  // namespace spoonbill
