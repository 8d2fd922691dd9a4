// Tessellation of surfaces within a chord error, and shells and volumes of the meshes. The functions have no
// side effects, may run on any thread, and are too slow for a tick.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct Tessellation {
  // Seams and poles are welded if their points coincide to closing_tolerance_m. Normals point outward if
  // every side of the surface is a seam or a pole.
  TriangleMesh mesh;
  bool closed = false;  // true if every side is a seam or a pole, and no trim loop cuts the surface
  // Largest distance between a point of the surface and the point of its triangle at the same parameters, or
  // between a trim loop and the edges that replace it. It may exceed the requested error by
  // closing_tolerance_m because of welding. It may also exceed the requested error by the error of the edges
  // along trim loops, if that error is more than half of the requested error.
  double chord_error_m = 0.0;
};

inline constexpr Range<double> chord_range_m{1e-7, 0.1};
inline constexpr std::size_t exported_triangle_limit = 10'000'000;

// Tessellates the part of a surface that remains after trimming. The cells are finer where the surface bends,
// and no cell crosses a knot. A cell of sides h_u and h_v is within (h_u^2 |S_uu| + h_v^2 |S_vv|) / 8 of the
// bilinear patch through its corners (surface_levels.h). The patch is within |P00 - P10 - P01 + P11| / 4 of
// its triangles, for corners P. Both bounds hold for cells that loops cut. A loop's polygon deviates from the
// loop by at most the fraction polygon_error_fraction() of the domain, and the surface stretches this
// distance by at most its first derivatives. Refused: more triangles than the limit, loops that bound no
// area, a request to stop.
Result<Tessellation> tessellate(const Surface& surface, const std::vector<TrimLoop>& trims, double chord_m,
                                std::size_t triangle_limit = exported_triangle_limit,
                                const Progress& progress = {});

// Returns the volume that a closed mesh encloses, by the divergence theorem; negative if its normals point
// inward.
double enclosed_volume_m3(const TriangleMesh& mesh);

// Returns a shell: the outer mesh, a copy of it moved back by `thickness_m` (above 0) along the vertex
// normals, and walls between the boundary edges of both. A vertex normal is the area-weighted mean of the
// normals of its triangles. The shell is closed if no edge of the outer mesh has more than two triangles. On
// a face of radius r, the distance between both meshes differs from the thickness by about the square of a
// triangle's side divided by r. Refused: a shell thicker than the radius of curvature, whose inner triangles
// would turn over; the message gives the position.
Result<TriangleMesh> thicken_mesh(const TriangleMesh& outer, double thickness_m);

}  // namespace spoonbill
