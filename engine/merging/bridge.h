// Joints between consecutive patches of a row: measures of their edges, search for folds, bridges over gaps.
// Pure functions, outside the tick; any thread.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Samples of the end edge of one patch and the start edge of the next, at the same parameters u.
struct JointEdges {
  std::vector<SurfacePoint> before, after;
};
JointEdges joint_edges(const Surface& before, const Surface& after);

double largest_gap_m(const JointEdges& edges);
double mean_gap_m(const JointEdges& edges);

// Returns the mean distance by which the second edge is ahead of the first, along the patches' direction
// there; negative where they overlap.
double mean_advance_m(const JointEdges& edges);

// A deviation below this is rounding.
inline constexpr double rounding_m = 1e-12;

// Returns true if, across every gap wider than `touching_m`, the patches continue straight ahead, neither
// sideways nor backwards.
bool continues_ahead(const JointEdges& edges, double touching_m);

// Returns the stretch s that minimises the sum of |before' - after' / s|^2; exact if the derivatives differ
// by a constant factor. Derivatives that point in different directions give the ratio of their lengths.
double stretch_at_edge(const JointEdges& edges);

// Returns true if the derivatives of both patches agree up to order `continuity`, so that no blend is needed.
// The patches must have equal degrees and equal knots along u.
bool is_smooth(const Surface& before, const Surface& after, double stretch, int continuity);

double mean_speed(const std::vector<SurfacePoint>& points);

// Returns the length of the last (`at_end`) or first polynomial piece along v at the given speed (metres per
// unit of v).
double piece_length_m(const Surface& patch, bool at_end, double speed);

// Returns the mean arc length of the lines along v from `start` to `end`.
double mean_length_m(const Surface& surface, double start, double end);

// Returns a position where the normal turns by more than 90 degrees from one cell to the next. Each
// polynomial piece has 4 x 4 cells. Creases (knots of full multiplicity) are not crossed, since two sides may
// meet there at any angle.
std::optional<Vector3> find_fold(const Surface& surface);

// Finds folds in the strip from v = `start` to v = `end`. Besides sudden turns it detects slow ones: normals
// that oppose the normals at both edges although these agree, and neighbouring lines that oppose each other
// although they agree at both edges.
std::optional<Vector3> find_fold_between(const Surface& surface, double start, double end);

// Length of a bridge. The speed across the gap is the same for both patches; it follows from the chords
// between the edges and the mean derivatives there. The parameter length is reduced until the bridge does not
// fold. Between rings it is also reduced, to a quarter at most, until the bridge is nowhere narrower than the
// narrower ring. Fails for edges without a direction across v, and for bridges that fold at any length unless
// `may_fold` is set.
struct BridgeLength {
  double parameter = 0.0;
  double stretch_of_after = 1.0;
  double chord_m = 0.0;  // mean distance between the edges
};
Result<BridgeLength> bridge_length(const Surface& before, const Surface& after, int continuity,
                                   bool may_fold = false);

// Returns the bridge from the end of `before` to the start of `after`, over the domain between them. Both
// need the same knots along u and the same degree along v. The outer control points continue the patches' end
// pieces with at least the given continuity. Between rings that are more than 45 degrees from facing each
// other, or farther apart than twice the sum of their radii, columns in between follow a bend and keep the
// tube open. Fails for an empty gap.
Result<Surface> bridge(const Surface& before, const Surface& after, int continuity);

}  // namespace spoonbill
