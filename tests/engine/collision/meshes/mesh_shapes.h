// Meshes of known shape, and a slow, independent answer to how far a point is from one.
#pragma once

#include "engine/collision/meshes/triangle_mesh.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {

TriangleMesh box_of_triangles(const Vector3& low, const Vector3& high);
// Rings of latitude and poles on the y axis, corners on the sphere.
TriangleMesh ball_mesh(int rings, int around, double radius_m, const Vector3& centre_m = Vector3::Zero());
// About the y axis. A tube thicker than its way round goes through itself.
TriangleMesh torus_mesh(int along, int around, double displacement_m, double tube_m);
// Of side x side squares over the unit square in x and y, z = height x y.
TriangleMesh sheet_mesh(int side, double height_m);
TriangleMesh moebius_strip(int along);
// 0.2 thick in radius, along a figure of eight in y = 0 that crosses itself in the origin.
TriangleMesh crossing_tube(int along, int around);

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);
TriangleMesh turned(TriangleMesh mesh);                         // inside out
TriangleMesh soup(const TriangleMesh& mesh);                    // each triangle with vertices of its own
TriangleMesh without(TriangleMesh mesh, int first, int count);  // of those triangles

// Cleans what must be clean enough.
CleanMesh cleaned(const TriangleMesh& mesh);

// Without sign, over all triangles: each one's plane where the foot lies in it, and its three sides.
double brute_distance(const TriangleMesh& mesh, const Vector3& point);
// By three rays in random directions: inside when most of them leave more often than they enter.
bool brute_inside(const TriangleMesh& mesh, const Vector3& point, Random& random);

Vector3 random_point(Random& random, double extent_m);
// Fifty times as many where every case is asked for.
int random_point_count(int few);

}  // namespace spoonbill
