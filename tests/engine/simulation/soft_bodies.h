// Soft bodies for tests, and how deep two of them are in each other.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/scene/material.h"

namespace spoonbill {

// Elastic, of the test clay's stiffness.
Material silicone();

// By the collider that knows nothing of constraints. Bodies that enclose each other fail the test.
double depth_between(const Surface& first, const Surface& second);

}  // namespace spoonbill
