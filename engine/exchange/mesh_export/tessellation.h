// Surfaces as triangles, none of which is farther from its surface than a chord error.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct Tessellation {
  // Seams and poles are welded, what find_closing() calls so. Normals are outward where every side of the
  // surface is a seam or a pole.
  TriangleMesh mesh;
  bool closed = false;  // it is so, and whole
  // No point of the surface is farther from the point of its triangle at the same parameters, nor an edge
  // that a loop makes from the loop. What welding moves, at most closing_tolerance_m, comes on top of what
  // was asked for, and so do edges of loops of more than half of it.
  double chord_error_m = 0.0;
};

inline constexpr Range<double> chord_range_m{1e-7, 0.1};
inline constexpr std::size_t exported_triangle_limit = 10'000'000;

// A grid over the polynomial pieces, finer where the surface bends. A cell of sides h_u and h_v lies within
// (h_u^2 |S_uu| + h_v^2 |S_vv|) / 8 of the bilinear patch through its corners (surface_bounds.h), and that
// within |P00 - P10 - P01 + P11| / 4 of its triangles, those that trim loops cut too, whose corners lie on
// the patch. An edge that a loop makes is that of its polygon, within polygon_error_fraction() of the domain
// of the loop, which the surface stretches by no more than its first derivatives. Refused: more triangles
// than the limit, loops that bound nothing; a request to stop.
Result<Tessellation> tessellate(const Surface& surface, const std::vector<TrimLoop>& trims, double chord_m,
                                std::size_t triangle_limit = exported_triangle_limit,
                                const Progress& progress = {});

// By the divergence theorem; of a closed mesh, negative where its normals point inward.
double enclosed_volume_m3(const TriangleMesh& mesh);

}  // namespace spoonbill
