// Principal curvatures of a trimmed surface and their extremes, and a search for minima over the polynomial
// pieces of a surface. The functions are pure, may run on any thread, and are too slow for a tick.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

// Rectangle of parameters within one polynomial piece.
struct PieceCell {
  double u0, u1, v0, v1;

  double centre_u() const { return 0.5 * (u0 + u1); }
  double centre_v() const { return 0.5 * (v0 + v1); }
};

// Divides every polynomial piece into parts x parts cells; `parts` must be at least 1. The cells leave out a
// millionth of a piece at each end, because derivatives jump at knots. At a collapsed edge they leave out a
// hundredth, because derivatives are lost in rounding there.
std::vector<PieceCell> piece_cells(const Surface& surface, int parts);

struct ParameterMinimum {
  double u = 0.0, v = 0.0, value = 0.0;
};

// Finds the smallest `value` at the centres and corners of the cells, then refines the best cells by a
// pattern search with shrinking steps. Ignores values that are not finite; returns an infinite value if no
// value is finite.
ParameterMinimum find_minimum(const std::vector<PieceCell>& cells,
                              const std::function<double(double u, double v)>& value,
                              const Progress& progress = {});

// Principal curvatures in 1/m. They are positive where the surface is convex seen from the side of its
// normals du x dv. On a ball of radius r with outward normals, both are 1 / r.
struct PrincipalCurvatures {
  double smallest = 0.0, largest = 0.0;
};

// Returns the principal curvatures at a point, or nothing where du x dv vanishes.
std::optional<PrincipalCurvatures> compute_principal_curvatures(const SurfacePoint& point);

struct CurvatureExtreme {
  double curvature_per_m = 0.0;
  double u = 0.0, v = 0.0;
  Vector3 position_m = Vector3::Zero();
};

struct CurvatureRange {
  CurvatureExtreme smallest, largest;
  bool exists = false;  // false if no part of the surface has a curvature; the extremes then mean nothing
};

// Finds the smallest and the largest curvature over all polynomial pieces, on both sides of each knot, except
// within a hundredth of a piece from a pole. A smooth extreme has a relative accuracy of a millionth. Radii
// of curvature below a millionth of the surface's size are ignored. No extreme exists on a surface without
// extent or area, or if `progress` stopped the search.
CurvatureRange find_curvature_range(const Surface& surface, const TrimmedArea& area = {},
                                    const Progress& progress = {});

// Returns the integral of the sum of the squared principal curvatures over the area. It has no unit, is small
// for fair surfaces, and is 8 pi for a ball of any size.
double compute_bending_energy(const Surface& surface, const TrimmedArea& area = {});

}  // namespace spoonbill
