// Moving, scaling and mirroring of bodies with everything that belongs to them.
#pragma once

#include "engine/base/geometry.h"
#include "engine/scene/body.h"

namespace spoonbill {

// Moves a body with its loads, its motion and the motions of its supports.
void move_body(const Pose& pose, Body& body);

// Scales a body along x, y and z by factors above 0; `fixed_m` keeps its place. Thickness and depths below
// the surface change by the geometric mean of the factors. Forces, pressures and the ways of motions keep
// their values.
void scale_body(const Vector3& factors, const Vector3& fixed_m, Body& body);

// Replaces a body by its mirror image in a plane, with its loads and motions. The normals point outward as
// before: u of a surface is reversed.
void mirror_body(const Vector3& point_m, const Vector3& normal, Body& body);

}  // namespace spoonbill
