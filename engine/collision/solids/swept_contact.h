// The first contact of a tool on its way: so that a fast one cannot pass through a thin sheet between two
// ticks.
#pragma once

#include "engine/collision/solids/surface_collider.h"

namespace spoonbill {

struct SweptContact {
  bool touches = false;
  double fraction = 1.0;   // of the way, up to which nothing touches
  SurfaceContact contact;  // where it touches, or the nearest point at that fraction
  // The tool came so near for so long that the steps ended at `fraction`, before the way did. Remedy: go on
  // from there, or take it as touching.
  bool undecided = false;
};

// A rigid motion: the position straight from one pose to the other, the orientation evenly about one axis.
struct ToolMotion {
  Pose from, to;
};

// The tool's frame is the pose. The surface stands still meanwhile and must have the collider's knots. By
// conservative advancement (Mirtich 1996): each step is no longer than the clearance over the farthest way of
// any of the tool's points, so that no contact is stepped over; it ends where they touch, to
// touch_tolerance_m. An endless solid must not turn. Allocates nothing; what collide() left is gone.
SweptContact sweep(SurfaceCollider& collider, const Surface& surface, const SignedDistance& solid,
                   const ToolMotion& motion);
SweptContact sweep_sphere(SurfaceCollider& collider, const Surface& surface, double radius_m,
                          const ToolMotion& motion);

}  // namespace spoonbill
