// Fits of clouds whose shape is known, and how far they are from it.
#pragma once

#include <functional>

#include "engine/fitting/fit_scan.h"

namespace spoonbill {

using Distance = std::function<double(const Vector3&)>;

// The largest distance of the surface from the known shape, on a grid of samples.
double farthest_off(const Surface& surface, const Distance& distance);

// With so many control points each way; one that is refused is a failure of the test, and empty.
ScanFit fit(const Scan& scan, int control, IslandChoice islands = IslandChoice::largest);

Distance from_sphere(double radius_m);

// By the divergence theorem over a grid of samples: what a closed surface encloses, above zero where it faces
// outwards.
double volume_of(const Surface& surface);

}  // namespace spoonbill
