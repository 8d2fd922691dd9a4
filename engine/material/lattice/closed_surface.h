// Whether a surface closes about a body, and its skin as triangles.
#pragma once

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/result.h"

namespace spoonbill {

// Whether the surface is a closed tube: periodic in u, a single point (a pole) at both ends of v, normals
// outward. The message says which of these fails.
Status check_closed_tube(const Surface& surface);

// The same of a closed tube, or of a ring: periodic in both directions.
Status check_closed(const Surface& surface);

// Triangles between samples of a surface that passed check_closed(), at least two an element and direction
// where it has fewer than `skin_samples` elements; what is one place, over a seam or at a pole, is one
// vertex.
inline constexpr int skin_samples = 200;
struct ClosedSkin {
  TriangleMesh mesh;
  std::vector<double> u, v;  // of each vertex; any u at a pole
};
ClosedSkin skin_of(const Surface& surface);

// What the surface encloses, by its skin; negative where its normals point inward. m3.
double enclosed_volume_m3(const ClosedSkin& skin);

}  // namespace spoonbill
