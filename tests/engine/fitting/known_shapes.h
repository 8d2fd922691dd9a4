// Fits of clouds on known shapes, and the distances of fitted surfaces from these shapes.
#pragma once

#include <functional>

#include "engine/fitting/fit_scan.h"

namespace spoonbill {

using Distance = std::function<double(const Vector3&)>;

// Returns the largest distance of the surface from the known shape, on a grid of samples.
double farthest_off(const Surface& surface, const Distance& distance);

// Fits with `control` control points in each direction. A failed fit fails the test and returns an empty
// result.
ScanFit fit(const Scan& scan, int control, IslandChoice islands = IslandChoice::largest);

Distance from_sphere(double radius_m);

// Returns the enclosed volume by the divergence theorem over a grid of samples, positive for outward normals.
double volume_of(const Surface& surface);

}  // namespace spoonbill
