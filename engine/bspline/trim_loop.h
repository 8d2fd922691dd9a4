// A closed B-spline curve over the parameters (u, v) of a surface. It bounds the part that is kept: what lies
// to its left, seen with u to the right and v up, so that an outer loop runs counter-clockwise and that of a
// hole clockwise. Parameters, not metres. Values and pure functions outside the tick; any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/base/range.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_insertion.h"
#include "engine/bspline/knot_vector.h"

namespace spoonbill {

// Open knots whose curve ends where it starts, or periodic ones; a polygon is of degree 1. In a periodic
// direction of the surface a loop may cross the seam: it then leaves the domain, by a period at most.
struct TrimLoop {
  KnotVector knots;
  std::vector<double> u, v;  // a control point each

  friend bool operator==(const TrimLoop&, const TrimLoop&) = default;
};

inline constexpr Range<int> trim_control_point_count_range{2, 10000};

// Shares of the surface's domain: how far a loop may miss its own start or leave the domain by rounding, and
// how far the polygons that stand for loops may be from them.
inline constexpr double trim_rounding_share = 1e-6;
inline constexpr double trim_chord_share = 1e-5;
// Of all loops of a surface: a perforated sheet of some 300 holes.
inline constexpr std::size_t trim_chord_count_limit = 20000;

// A loop over the domain of a surface with the knot vectors `along_u` and `along_v`. Refused: as many
// coordinates as the knots do not ask for, a non-finite one, a curve that does not close (one that goes once
// around a periodic direction is to be led back along the seam), leaves the domain, crosses itself, encloses
// nothing, or takes more chords than the limit.
Result<TrimLoop> make_trim_loop(const KnotVector& along_u, const KnotVector& along_v, KnotVector knots,
                                std::vector<double> u, std::vector<double> v);

// The point of the curve at a parameter of its own domain.
Eigen::Vector2d position(const TrimLoop& loop, double parameter);

// The corners of a polygon within trim_chord_share of the loop, each once; none lies outside an open
// direction's domain. Every piece of the curve is cut evenly: a chord over the length h of parameter is
// within h^2 / 8 of the largest second derivative, which the control points of that derivative bound.
std::vector<Eigen::Vector2d> polygon_of(const TrimLoop& loop, const KnotVector& along_u,
                                        const KnotVector& along_v);

// In shares of the domain, how far that polygon can be from the loop: 0 for a polygon.
double polygon_error_share(const TrimLoop& loop, const KnotVector& along_u, const KnotVector& along_v);

// Positive when it runs counter-clockwise; in units of u times v.
double signed_area(const std::vector<Eigen::Vector2d>& polygon);

// The loop of the same part of a surface that is run through otherwise, as reparameterise.h does it:
// `knots` are those of the direction before.
TrimLoop reversed(const TrimLoop& loop, Direction direction, const KnotVector& knots);
TrimLoop exchanged(const TrimLoop& loop);
TrimLoop with_domain(const TrimLoop& loop, Direction direction, const KnotVector& knots, double start,
                     double end);
// Of a periodic direction.
TrimLoop with_seam_at(const TrimLoop& loop, Direction direction, const KnotVector& knots, double seam);

}  // namespace spoonbill
