// Trim loops: closed B-spline curves over the parameters (u, v) of a surface that bound its remaining part,
// and the search for crossings of their polygons. Coordinates are parameters, not metres. Plain values and
// pure functions outside the tick; any thread may use them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Two crossing edges: the polygons that they belong to, possibly the same, and a point near the crossing.
struct PolygonCrossing {
  std::size_t first = 0, second = 0;  // indices of the two polygons, first <= second
  Eigen::Vector2d near;
};

// Returns a pair of crossing edges of the polygons, if any. Edges that only touch, within `tolerance` (above
// 0) along each axis, do not cross. The time grows with the number of edges times the number of their
// neighbours in x.
std::optional<PolygonCrossing> find_crossing(const std::vector<std::vector<Eigen::Vector2d>>& polygons,
                                             const Eigen::Vector2d& tolerance);

// A closed curve, whose knots are periodic or open with ends that meet; a polygon has degree 1. Seen with u
// to the right and v up, the part to its left remains: outer loops run counter-clockwise, holes clockwise. In
// a periodic direction of the surface a loop may cross the seam; it then leaves the domain, by at most a
// period.
struct TrimLoop {
  KnotVector knots;
  std::vector<double> u, v;  // coordinates of the control points

  friend bool operator==(const TrimLoop&, const TrimLoop&) = default;
};

inline constexpr Range<int> trim_control_point_count_range{2, 10000};

// Fractions of the surface's domain. trim_rounding_fraction is how far a loop may miss its own start or leave
// the domain by rounding; trim_chord_fraction is how far the polygon of a loop may be from the loop.
inline constexpr double trim_rounding_fraction = 1e-6;
inline constexpr double trim_chord_fraction = 1e-5;
// Largest number of chords of all loops of a surface together, enough for a perforated sheet of about 300
// holes.
inline constexpr std::size_t trim_chord_count_limit = 20000;

// Makes a loop over the domain of a surface with the knot vectors `along_u` and `along_v`. Refuses a number
// of coordinates that does not match the knots, non-finite ones, and more chords than the limit. Refuses a
// curve that is not closed, leaves the domain, crosses itself or encloses nothing. A curve that runs once
// around a periodic direction must return along the seam.
Result<TrimLoop> make_trim_loop(const KnotVector& along_u, const KnotVector& along_v, KnotVector knots,
                                std::vector<double> u, std::vector<double> v);

// Returns the point of the curve at a parameter of its own domain.
Eigen::Vector2d position(const TrimLoop& loop, double parameter);

// Returns the corners of a polygon that is within trim_chord_fraction of the loop. Each corner occurs once;
// none is outside the domain of an open direction. Every piece of the curve is cut evenly. A chord over the
// length h of parameter deviates by at most h^2 / 8 times the largest second derivative, which is bounded by
// the control points of that derivative.
std::vector<Eigen::Vector2d> to_polygon(const TrimLoop& loop, const KnotVector& along_u,
                                        const KnotVector& along_v);

// Returns a bound of the distance between to_polygon() and the loop, in fractions of the domain; 0 for a loop
// of degree 1.
double polygon_error_fraction(const TrimLoop& loop, const KnotVector& along_u, const KnotVector& along_v);

// Returns the signed area in units of u times v, positive for a counter-clockwise polygon.
double signed_area(const std::vector<Eigen::Vector2d>& polygon);

// Each function below returns the loop that bounds the same part of the surface after the function of the
// same name in reparameterise.h has changed the surface. `knots` are the knots of the direction before that
// change.
TrimLoop reversed(const TrimLoop& loop, Direction direction, const KnotVector& knots);
TrimLoop exchanged(const TrimLoop& loop);
TrimLoop with_domain(const TrimLoop& loop, Direction direction, const KnotVector& knots, double start,
                     double end);
// Returns the loop that bounds the same part after with_seam_at() has moved the surface's seam; the direction
// must be periodic.
TrimLoop with_seam_at(const TrimLoop& loop, Direction direction, const KnotVector& knots, double seam);

}  // namespace spoonbill
