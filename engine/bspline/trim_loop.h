// Trim loops, and the search for crossings of polygons. A trim loop is a closed B-spline curve in the
// parameter domain of a surface; its coordinates are the parameters (u, v), not metres. The loops of a
// surface bound the part of the surface that is kept. All functions are pure, may be called from any thread,
// and are too slow for a tick.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Two polygon edges that cross: the polygons that they belong to, possibly the same, and a point near the
// crossing.
struct PolygonCrossing {
  std::size_t first = 0, second = 0;  // indices of the two polygons, first <= second
  Eigen::Vector2d near;
};

// Returns a pair of crossing edges of the polygons, if any. Edges that only touch do not cross. `tolerance`
// is the gap at which edges still touch, given for each axis; it must be above 0. The time grows with the
// number of pairs of edges whose ranges of x overlap.
std::optional<PolygonCrossing> find_crossing(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                             const Eigen::Vector2d& tolerance);

// A closed curve over the parameters of a surface. Either its knots are periodic, or they are open and the
// ends of the curve meet. A polygon is a loop of degree 1. Seen with u to the right and v up, the part to the
// left of the loop remains: outer loops run counter-clockwise, holes clockwise. In a periodic direction of
// the surface a loop may cross the seam; it then leaves the domain by at most one period.
struct TrimLoop {
  KnotVector knots;
  std::vector<double> u, v;  // coordinates of the control points

  friend bool operator==(const TrimLoop&, const TrimLoop&) = default;
};

inline constexpr Range<int> trim_control_point_count_range{2, 10000};

// Fractions of the surface's domain. trim_rounding_fraction is how far a loop may miss its own start or leave
// the domain by rounding; trim_chord_fraction is how far the polygon that replaces a loop (to_polygon()) may
// be from the loop.
inline constexpr double trim_rounding_fraction = 1e-6;
inline constexpr double trim_chord_fraction = 1e-5;
// Largest total number of chords (edges of polygons that replace loops) for all loops of a surface. It is
// enough for a perforated sheet of about 300 holes.
inline constexpr std::size_t trim_chord_count_limit = 20000;

// Makes a loop over the domain of a surface with the knot vectors `along_u` and `along_v`. Refuses a number
// of coordinates that does not match the knots, coordinates that are not finite, and more chords than
// trim_chord_count_limit. Refuses a curve that is not closed, leaves the domain, crosses itself or encloses
// nothing. A curve that runs once around a periodic direction must return along the seam.
Result<TrimLoop> make_trim_loop(const KnotVector& along_u, const KnotVector& along_v, KnotVector knots,
                                std::vector<double> u, std::vector<double> v);

// Returns the point of the curve at a parameter of its own domain.
Eigen::Vector2d position(const TrimLoop& loop, double parameter);

// Returns the corners of a polygon that is within trim_chord_fraction of the loop. Only if the loop has very
// distant control points may the polygon be farther away (see polygon_error_fraction()). Each corner occurs
// once; none is outside the domain of an open direction. Every polynomial piece of the curve is divided
// evenly. A chord over a parameter range of length h deviates from the curve by at most h^2 / 8 times the
// largest second derivative, for which the control points of the derivative give a bound.
std::vector<Eigen::Vector2d> to_polygon(const TrimLoop& loop, const KnotVector& along_u,
                                        const KnotVector& along_v);

// Returns a bound of the distance between to_polygon() and the loop, in fractions of the domain; 0 for a loop
// of degree 1.
double polygon_error_fraction(const TrimLoop& loop, const KnotVector& along_u, const KnotVector& along_v);

// Returns the signed area of a polygon, in units of u times v; positive if the polygon is counter-clockwise.
double signed_area(const std::vector<Eigen::Vector2d>& polygon);

// Returns the loop that bounds the same part of a surface after the function of this name in reparameterise.h
// has changed the surface. `knots` are the surface's knots along `direction` before the change.
TrimLoop reversed(const TrimLoop& loop, Direction direction, const KnotVector& knots);
TrimLoop exchanged(const TrimLoop& loop);
TrimLoop with_domain(const TrimLoop& loop, Direction direction, const KnotVector& knots, double start,
                     double end);
// Returns the loop that bounds the same part of a surface after with_seam_at() has moved the surface's seam.
// The direction must be periodic. `knots` are the surface's knots along `direction` before the change.
TrimLoop with_seam_at(const TrimLoop& loop, Direction direction, const KnotVector& knots, double seam);

}  // namespace spoonbill
