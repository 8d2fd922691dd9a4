// Whether a surface closes about a body, and its skin as triangles.
#pragma once

#include <array>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// Whether the surface is a closed tube: periodic in u, a single point (a pole) at both ends of v, normals
// outward. The message says which of these fails.
Status check_closed_tube(const Surface& surface);

// The same of a closed tube, or of a ring: periodic in both directions.
Status check_closed(const Surface& surface);

// Triangles between samples of a surface whose ends close as check_closed() asks, whichever way its normals
// point; what is one place, over a seam or at a pole, is one vertex.
struct ClosedSkin {
  TriangleMesh mesh;
  std::vector<double> u, v;                    // of each vertex; any u at a pole
  std::vector<std::array<double, 2>> middles;  // u and v in the middle of each triangle
};
ClosedSkin skin_of(const Surface& surface);

// The samples of skin_of() in a direction: about `skin_samples`, two to eight an element, two also where that
// is more.
inline constexpr int skin_samples = 200;
std::vector<double> skin_parameters(const KnotVector& knots);

// At other samples, from the start of both domains to their ends.
ClosedSkin skin_between(const Surface& surface, const std::vector<double>& u, const std::vector<double>& v);

// What the surface encloses, by its skin; negative where its normals point inward. m3.
double enclosed_volume_m3(const ClosedSkin& skin);

}  // namespace spoonbill
