// Meshes of known shape, and a slow, independent computation of a point's distance from a mesh.
#pragma once

#include "engine/collision/meshes/triangle_mesh.h"
#include "tests/engine/bspline/random_surface.h"

namespace spoonbill {

TriangleMesh box_of_triangles(const Vector3& low, const Vector3& high);
// Returns a ball of rings of latitude, with poles on the y axis. All vertices are on the sphere.
TriangleMesh ball_mesh(int rings, int around, double radius_m, const Vector3& centre_m = Vector3::Zero());
// Returns a torus about the y axis. It intersects itself if `tube_m` exceeds `displacement_m`, the radius of
// the ring.
TriangleMesh torus_mesh(int along, int around, double displacement_m, double tube_m);
// Returns side x side squares over the unit square in x and y, with z = height_m * x * y.
TriangleMesh sheet_mesh(int side, double height_m);
TriangleMesh moebius_strip(int along);
// Returns a tube, 0.2 in radius, along a figure of eight in the plane y = 0. It crosses itself at the origin.
TriangleMesh crossing_tube(int along, int around);

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);
TriangleMesh turned(TriangleMesh mesh);       // Returns the mesh inside out.
TriangleMesh soup(const TriangleMesh& mesh);  // Returns the mesh without shared vertices.
// Returns the mesh without `count` triangles from the index `first` on.
TriangleMesh without(TriangleMesh mesh, int first, int count);

// Returns the cleaned mesh; fails the test if it cannot be cleaned.
CleanMesh cleaned(const TriangleMesh& mesh);

// Returns the unsigned distance of the point from the mesh. Tests each triangle: its three sides, and its
// plane if the foot of the perpendicular is inside the triangle.
double brute_distance(const TriangleMesh& mesh, const Vector3& point);
// Casts three rays in random directions. Returns true if most of the rays leave the mesh more often than they
// enter it.
bool brute_inside(const TriangleMesh& mesh, const Vector3& point, Random& random);

Vector3 random_point(Random& random, double extent_m);
// Returns `few`, under a sanitizer a quarter of it, or in a long run fifty times as many.
int random_point_count(int few);

}  // namespace spoonbill
