// Joints between consecutive patches of a row: measures of their edges, a search for folds, and bridges over
// gaps. The functions have no side effects, may run on any thread, and are too slow for a tick.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Surface points on both edges of a joint, at the same parameters u: on the end edge of one patch and on the
// start edge of the next.
struct JointEdges {
  std::vector<SurfacePoint> before, after;
};
JointEdges joint_edges(const Surface& before, const Surface& after);

double largest_gap_m(const JointEdges& edges);
double mean_gap_m(const JointEdges& edges);

// Returns the mean distance by which the second edge is ahead of the first, along the direction of the
// patches at the joint. It is negative where the patches overlap.
double mean_advance_m(const JointEdges& edges);

// Largest deviation in metres that counts as rounding.
inline constexpr double rounding_m = 1e-12;

// Returns true if the patches continue straight ahead, neither sideways nor backwards, across every gap wider
// than `touching_m`.
bool continues_ahead(const JointEdges& edges, double touching_m);

// Returns the stretch s that minimises the sum of |after' - s before'|^2 over the derivatives across the
// joint. It is exact if the derivatives differ by a constant factor. If they point in very different
// directions, it is the ratio of their lengths.
double stretch_at_edge(const JointEdges& edges);

// Returns true if the derivatives of both patches agree up to order `continuity`, so that no blend is needed.
// The patches must have equal degrees and equal knots along u.
bool is_smooth(const Surface& before, const Surface& after, double stretch, int continuity);

double mean_speed(const std::vector<SurfacePoint>& points);

// Returns the length, along v, of the last (`at_end`) or first polynomial piece of a patch, at the given
// speed in metres per unit of v.
double piece_length_m(const Surface& patch, bool at_end, double speed);

// Returns the mean arc length of the surface's lines of constant u between v = `start` and v = `end`.
double mean_length_m(const Surface& surface, double start, double end);

// Returns a position where the normal turns by more than 90 degrees from one cell to the next. Each
// polynomial piece has 4 x 4 cells. Cells on both sides of a crease (a knot of full multiplicity) are not
// compared, because the surface may bend there by any angle.
std::optional<Vector3> find_fold(const Surface& surface);

// Returns a position of a fold in the strip from v = `start` to v = `end`; nothing if there is no fold. A
// fold is a sudden turn of the normal, as for find_fold(), or a slow turn in one of two forms: a normal
// opposes the normals at both edges of the strip, although these agree with each other; or the normals on two
// neighbouring lines of constant u oppose each other, although they agree at both edges.
std::optional<Vector3> find_fold_between(const Surface& surface, double start, double end);

// Length of a bridge along v. bridge_length() computes it from the mean distance between the edges and from
// the mean derivative of the first patch along v at its edge. `stretch_of_after` gives the second patch the
// same derivative. If the bridge folds, bridge_length() reduces the length until it does not. Between rings
// it also reduces the length, but not below about a quarter, until the bridge is nowhere narrower than the
// narrower ring. It fails for edges at which the derivatives along v vanish and, unless `may_fold` is set,
// for a bridge that folds at any length.
struct BridgeLength {
  double parameter = 0.0;
  double stretch_of_after = 1.0;
  double chord_m = 0.0;  // mean distance between the edges
};
Result<BridgeLength> bridge_length(const Surface& before, const Surface& after, int continuity,
                                   bool may_fold = false);

// Returns the bridge from the end of `before` to the start of `after`, over the domain between them. Both
// patches need the same knots along u and the same degree along v. The outer control points continue the
// patches' end pieces with at least the given continuity. Further columns in between follow a bend and keep
// the tube open. They are added between rings that are more than 45 degrees from facing each other, or
// farther apart than twice the sum of their radii. Fails for a gap of no length in v.
Result<Surface> bridge(const Surface& before, const Surface& after, int continuity);

}  // namespace spoonbill
