#include "engine/collision/solids/swept_contact.h"

#include <algorithm>
#include <cmath>

namespace spoonbill {
namespace {

constexpr int most_steps = 400;
// Over the way of the motion itself, for the rounding of its poses.
constexpr double motion_rounding = 1e-9;

// The farthest of the solid from the origin of its frame, about which it turns.
double farthest(const SignedDistance& solid) {
  const Box bounds = solid.bounds();
  return bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).norm();
}

Pose pose_at(const ToolMotion& motion, double fraction) {
  const Pose& from = motion.from;
  return {from.position_m + fraction * (motion.to.position_m - from.position_m),
          from.orientation.slerp(fraction, motion.to.orientation)};
}

template <class ToolAt>
SweptContact advance(SurfaceCollider& collider, const Surface& surface, double way, const ToolAt& tool_at) {
  SweptContact result;
  double fraction = 0.0;
  for (int step = 0; step < most_steps; ++step) {
    const Clearance clearance = collider.clearance(surface, tool_at(fraction));
    result.fraction = fraction;
    result.contact = clearance.nearest;
    if (clearance.nearest.depth_m >= -touch_tolerance_m) {
      result.touches = true;
      return result;
    }
    if (clearance.overflow) break;
    if (fraction >= 1.0) return result;
    // Of a tool that stands still, the end of the way is as its start.
    fraction = way > 0.0 ? std::min(fraction + clearance.surely_m / way, 1.0) : 1.0;
  }
  result.undecided = true;
  return result;
}

double straight_way(const ToolMotion& motion) {
  return (motion.to.position_m - motion.from.position_m).norm() * (1.0 + motion_rounding);
}

}  // namespace

SweptContact sweep(SurfaceCollider& collider, const Surface& surface, const SignedDistance& solid,
                   const ToolMotion& motion) {
  const double angle =
      motion.from.orientation.normalized().angularDistance(motion.to.orientation.normalized());
  const double turned = angle > 0.0 ? angle * farthest(solid) * (1.0 + motion_rounding) : 0.0;
  return advance(collider, surface, straight_way(motion) + turned,
                 [&](double fraction) { return ToolShape::solid(solid, pose_at(motion, fraction)); });
}

SweptContact sweep_sphere(SurfaceCollider& collider, const Surface& surface, double radius_m,
                          const ToolMotion& motion) {
  return advance(collider, surface, straight_way(motion), [&](double fraction) {
    return ToolShape::sphere(pose_at(motion, fraction).position_m, radius_m);
  });
}

}  // namespace spoonbill
