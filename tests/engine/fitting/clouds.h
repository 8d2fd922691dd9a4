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

Vector3 on_cylinder(double s, double t, double radius_m, double length_m);  // open, along z from 0
Vector3 on_torus_sector(double s, double t, double displacement_m,
                        double tube_m);                                 // open, a quarter turn about z
Vector3 on_waves(double s, double t, double width_m, double height_m);  // over x and y
double waves_height(double x_m, double y_m, double width_m, double height_m);

void add_noise(Scan& scan, std::uint64_t seed, double deviation_m);
// Adds random points within the scan's bounding box. Their number is the fraction `share` of the scan's
// points.
void add_outliers(Scan& scan, std::uint64_t seed, double share);
void leave_out(Scan& scan, const std::function<bool(const Vector3&)>& out);
void append(Scan& scan, const Scan& other, const Vector3& moved_m);

}  // namespace spoonbill
