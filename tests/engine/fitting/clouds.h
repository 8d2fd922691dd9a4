// Clouds of points on surfaces of known shape, in metres.
#pragma once

#include <cstdint>
#include <functional>

#include "engine/fitting/scan.h"

namespace spoonbill {

// Evenly over the sphere (golden spiral), stretched to semi-axes.
Scan ellipsoid_cloud(int count, const Vector3& semi_axes_m);
// place(s, t) at random s, t in 0..1.
Scan random_cloud(int count, std::uint64_t seed, const std::function<Vector3(double, double)>& place);

Vector3 on_cylinder(double s, double t, double radius_m, double length_m);  // along z from 0, open
Vector3 on_torus_sector(double s, double t, double displacement_m, double tube_m);   // a quarter turn about z, open
Vector3 on_waves(double s, double t, double width_m, double height_m);      // over x, y
double waves_height(double x_m, double y_m, double width_m, double height_m);

void add_noise(Scan& scan, std::uint64_t seed, double deviation_m);
// At random in the scan's box, as many more as the share of its points.
void add_outliers(Scan& scan, std::uint64_t seed, double share);
void leave_out(Scan& scan, const std::function<bool(const Vector3&)>& out);
void append(Scan& scan, const Scan& other, const Vector3& moved_m);

}  // namespace spoonbill
