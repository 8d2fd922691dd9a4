// How one ring must be turned to face another, and the bend by which a tube gets from one to the other. Pure
// functions, outside the tick; any thread.
#pragma once

#include <Eigen/Core>

#include "engine/merging/patch_edge.h"

namespace spoonbill {

// Where a tube ends: the middle and the largest radius of its ring, and the unit direction out of the tube,
// zero where there is none.
struct RingPlace {
  Vector3 centre_m = Vector3::Zero();
  double radius_m = 0.0;
  Vector3 outward = Vector3::Zero();
};
RingPlace ring_place(const Surface& surface, Side side);

// The turn of what leads out of b into what leads into a: least far, and where both face the same way in the
// plane in which a bend joins them. None for rings that lie within each other and face the same way, such as
// those of a cup's two walls at its rim, or that lead nowhere.
Eigen::Matrix3d turn_towards(const RingPlace& a, const RingPlace& b);

// By how much a bend around an arc is longer than its chord.
double bend_stretch(const Eigen::Matrix3d& turn);

// Whether the turn is one that a straight strip would pinch: more than an eighth of a whole turn.
bool is_bend(const Eigen::Matrix3d& turn);

// The columns of a net between two of them, which are rings: carried along a bend that leads out of the first
// in the direction `outward`, turned as the second is from the first, which is `turn` backwards.
void fill_bend(ControlNet& net, int first, int last, const Vector3& outward, const Eigen::Matrix3d& turn);

}  // namespace spoonbill
