// Point clouds on surfaces of known shape, in metres.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/fitting/scan.h"

namespace spoonbill {

// Returns evenly spread points on a sphere (golden spiral), scaled to the semi-axes.
Scan ellipsoid_cloud(int count, const Vector3& semi_axes_m);
// Returns the points place(s, t) for random s and t in [0, 1].
Scan random_cloud(int count, std::uint64_t seed, const std::function<Vector3(double, double)>& place);

// on_cylinder() returns a point of an open cylinder along z, which starts at z = 0. on_torus_sector() returns
// a point of an open tube that is bent by a quarter turn about z. on_waves() returns a point of a wavy sheet
// over x and y.
Vector3 on_cylinder(double s, double t, double radius_m, double length_m);
Vector3 on_torus_sector(double s, double t, double displacement_m, double tube_m);
Vector3 on_waves(double s, double t, double width_m, double height_m);
double waves_height(double x_m, double y_m, double width_m, double height_m);

void add_noise(Scan& scan, std::uint64_t seed, double deviation_m);
// Adds random points within the scan's bounding box. Their number is the fraction `share` of the scan's
// points.
void add_outliers(Scan& scan, std::uint64_t seed, double share);
void leave_out(Scan& scan, const std::function<bool(const Vector3&)>& out);
void append(Scan& scan, const Scan& other, const Vector3& moved_m);

}  // namespace spoonbill
