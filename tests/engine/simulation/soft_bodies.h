// Provides soft bodies for tests, and the penetration of two bodies.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Elastic material with the stiffness of the test clay.
Material silicone();

// Returns the penetration of two bodies according to the collider, which is independent of the constraints.
// Bodies that enclose each other fail the test.
double depth_between(const Surface& first, const Surface& second);

// Returns the least height of a control point.
double lowest(const Surface& surface);

}  // namespace spoonbill
