// Edges of patches, and the rings at the ends of tubes. The functions have no side effects, may run on any
// thread, and are too slow for a tick.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/bspline/reparameterise.h"
#include "engine/bspline/surface.h"

namespace spoonbill {

// Side of a patch, at the start or end of u or v. A periodic direction has no sides.
enum class Side { u_start, u_end, v_start, v_end };

inline constexpr Side all_sides[] = {Side::u_start, Side::u_end, Side::v_start, Side::v_end};

// across() returns the direction whose parameter is constant along the edge of the side. is_start() returns
// true if the side is at the start of that direction.
Direction across(Side side);
bool is_start(Side side);
Side opposite(Side side);

// Returns the name used in files and commands, such as "u_start".
const char* side_name(Side side);

// Side of one of several patches. Patches are counted from 0.
struct PatchEdge {
  int patch = 0;
  Side side = Side::v_end;

  friend bool operator==(const PatchEdge&, const PatchEdge&) = default;
};

// The curve of a patch's edge, as a function of the parameter along the edge.
struct EdgeCurve {
  KnotVector knots;
  std::vector<Vector3> control_points_m;
};
EdgeCurve edge_curve(const Surface& surface, Side side);

Vector3 position(const EdgeCurve& curve, double t);
// Returns the first derivative with respect to the parameter.
Vector3 derivative(const EdgeCurve& curve, double t);

// Returns true if the edge can be joined: it is not a pole, and the direction across it is open.
bool is_joinable(const Surface& surface, Side side);

// Returns the mean unit direction that leads out of the patch across an edge. Returns zero if the directions
// cancel each other.
Vector3 outward(const Surface& surface, Side side);

// Points of an edge at equal steps of arc length, including both ends. On a periodic edge they start at the
// seam and do not repeat it.
struct EdgeSamples {
  std::vector<double> parameters;
  std::vector<Vector3> points_m;
  double length_m = 0.0;
};
EdgeSamples edge_samples(const EdgeCurve& curve, int count);

// The end ring of a tube: its centre, its largest radius, and the unit direction out of the tube (zero if
// undefined).
struct RingFrame {
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 outward = Vector3::Zero();
};
RingFrame ring_frame(const Surface& surface, Side side);

// Returns the smallest rotation that maps the inward direction at b to the outward direction at a. If both
// rings face in the same direction, the rotation is in the plane of the bend that joins them. Returns the
// identity for nested rings that face in the same direction, such as both walls of a cup at its rim, and for
// rings without a direction.
Eigen::Matrix3d rotation_towards(const RingFrame& a, const RingFrame& b);

// Returns the ratio of arc length to chord for a circular bend that turns by the given rotation.
double bend_stretch(const Eigen::Matrix3d& turn);

// Returns true if a straight strip between rings with this relative rotation would be pinched, which is the
// case above 45 degrees.
bool is_bend(const Eigen::Matrix3d& turn);

// Fills the columns of a net between the ring in column `first` and the ring in column `last`, along a bend.
// The bend leaves the first ring in the direction `outward`. `turn` rotates the last ring back to the first.
void fill_bend(ControlNet& net, int first, int last, const Vector3& outward, const Eigen::Matrix3d& turn);

}  // namespace spoonbill
