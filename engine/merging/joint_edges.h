// The two edges between which patches of a row are joined, and what they say of how to. Pure functions,
// outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/bspline/surface.h"

namespace spoonbill {

// At the end of one patch and the start of the next, at the same parameters across.
struct JointEdges {
  std::vector<SurfacePoint> before, after;
};
JointEdges joint_edges(const Surface& before, const Surface& after);

double largest_gap_m(const JointEdges& edges);
double mean_gap_m(const JointEdges& edges);

// How far the edge after lies ahead of that before, in the direction in which both patches run there; below
// zero where they overlap. The mean.
double mean_advance_m(const JointEdges& edges);

// Whether patches run straight on across the gap, where it is wider than `touching_m`: not sideways nor back.
bool leads_on(const JointEdges& edges, double touching_m);

// The stretch s with the least sum of |before' - after' / s|^2, up to its scale; exact where the derivatives
// differ by one factor. By the lengths alone where they point elsewhere.
double stretch_at_edge(const JointEdges& edges);

// Whether derivatives up to the continuity agree so far that no blend is needed, of patches with the same
// degrees and the same knots across.
bool is_smooth(const Surface& before, const Surface& after, double stretch, int continuity);

double mean_speed(const std::vector<SurfacePoint>& points);

// How long the polynomial piece at the end or the start of a patch is, at a speed.
double piece_length_m(const Surface& patch, bool at_end, double speed);

// Of the lines along v from one parameter to another.
double mean_length_m(const Surface& surface, double start, double end);

}  // namespace spoonbill
