// Closed surfaces: checks, the enclosed volume and a triangle skin.
#pragma once

#include <array>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Checks that the surface is a closed tube: periodic in u, a single point (a pole) at both ends of v, normals
// outward.
Status check_closed_tube(const Surface& surface);

// Checks that the surface is a closed tube or a ring, which is periodic in both directions, with outward
// normals.
Status check_closed(const Surface& surface);

// Triangles between samples of a surface that closes as check_closed() requires. The surface's normals may
// point in either direction. Points that coincide across a seam or at a pole are one vertex.
struct ClosedSkin {
  TriangleMesh mesh;
  std::vector<double> u, v;                             // parameters of each vertex; u is arbitrary at a pole
  std::vector<std::array<double, 2>> triangle_centres;  // u and v at the centroid of each triangle
};
// Samples a closed surface at its skin_parameters().
ClosedSkin make_skin(const Surface& surface);

// Approximate number of parameters that skin_parameters() returns for one direction. Each element gets two to
// eight samples, so a direction of many elements has more than this number, and a direction of few elements
// fewer.
inline constexpr int skin_samples = 200;
std::vector<double> skin_parameters(const KnotVector& knots);

// Samples a closed surface at the given parameters, which ascend from the start of each domain to its end.
ClosedSkin sample_skin(const Surface& surface, const std::vector<double>& u, const std::vector<double>& v);

// Returns the volume that the skin encloses, in cubic metres; negative if its normals point inward.
double enclosed_volume_m3(const ClosedSkin& skin);

}  // namespace spoonbill
