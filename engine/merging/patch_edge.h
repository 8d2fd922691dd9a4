// The edges of a patch, where patches are joined. Pure functions, outside the tick; any thread.
#pragma once

#include <vector>

#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Where u or v is at its start or end. A periodic direction has no such edges.
enum class Side { u_start, u_end, v_start, v_end };

inline constexpr Side all_sides[] = {Side::u_start, Side::u_end, Side::v_start, Side::v_end};

// The direction that is constant along the edge, and whether it is at its start there.
Direction across(Side side);
bool is_start(Side side);
Side opposite(Side side);

// "u_start" and so on, as files and commands name them.
const char* side_name(Side side);

// One of several patches, counted from 0.
struct PatchEdge {
  int patch = 0;
  Side side = Side::v_end;

  friend bool operator==(const PatchEdge&, const PatchEdge&) = default;
};

// An edge as a curve of the other direction's parameter.
struct EdgeCurve {
  KnotVector knots;
  std::vector<Vector3> control_points_m;
};
EdgeCurve edge_curve(const Surface& surface, Side side);

Vector3 position(const EdgeCurve& curve, double t);
// The first derivative by the parameter.
Vector3 derivative(const EdgeCurve& curve, double t);

// Whether the side is one to join: the direction across is open and the edge longer than nothing.
bool is_joinable(const Surface& surface, Side side);

// The mean unit direction out of the patch across an edge; zero where the directions cancel.
Vector3 outward(const Surface& surface, Side side);

// `count` points at equal steps of the arc length, ends included; of a periodic edge from its seam on,
// without repeating it.
struct EdgeSamples {
  std::vector<double> parameters;
  std::vector<Vector3> points_m;
  double length_m = 0.0;
};
EdgeSamples edge_samples(const EdgeCurve& curve, int count);

}  // namespace spoonbill
