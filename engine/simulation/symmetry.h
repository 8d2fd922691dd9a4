// The mirrored side of a symmetric stroke.
#pragma once

#include "engine/base/geometry.h"
#include "engine/scene/scene.h"

namespace spoonbill {

Vector3 mirrored_point(const Symmetry& symmetry, const Vector3& point_m);

// A reflection turns every rotation around: its axis, a pseudovector, keeps its part along the normal and
// changes the sign of the rest.
Pose mirrored_pose(const Symmetry& symmetry, const Pose& pose);

}  // namespace spoonbill
