// Provides soft bodies for tests, and the penetration of two bodies.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Returns an elastic material with the stiffness of the test clay.
Material silicone();

// Returns the penetration of two bodies as measured by the collider, which is independent of the contact
// constraints. Bodies that enclose each other fail the test.
double depth_between(const Surface& first, const Surface& second);

// Returns the smallest height of a control point.
double lowest(const Surface& surface);

}  // namespace spoonbill
