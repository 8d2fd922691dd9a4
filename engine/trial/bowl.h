// The bowl of a body that bears food: its rim, its frame and its sizes, found on any spoon.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/body.h"

namespace spoonbill {

// A bowl, in the position of its body. Plain data. The sides of the frame, seen from above with the front
// ahead: `left()` is on the left.
struct Bowl {
  // Corners of the rim as in Body::rim, counter-clockwise seen from above; the first is straight ahead of the
  // centre.
  std::vector<Vector2> rim;
  Vector3 centre_m = Vector3::Zero();    // of the rim
  Vector3 normal = Vector3::UnitY();     // of the rim's plane (Rim), upwards
  Vector3 front = Vector3::UnitX();      // in the rim's plane, away from the rest of the body
  double length_m = 0.0, width_m = 0.0;  // extents of the rim along `front` and across it
  double depth_m = 0.0;                  // from the rim's plane to the lowest point of the inside

  Vector3 left() const { return normal.cross(front); }
  // Unit vector of the axis about which a positive turn lifts the front.
  Vector3 tilt_axis() const { return front.cross(normal); }
  // Returns the angle by which the front of the rim is above the back, given the direction against gravity.
  double pitch_deg(const Vector3& up) const;
};

inline constexpr int bowl_rim_corners = 192;

// Finds the bowl of a body with a surface. A known rim (Body::rim) is taken as it is. Otherwise the bowl is
// the hollow that would hold most water, and its rim is the ridge around it: along each ray from the bowl's
// deepest point, the highest point before the body ends. Where the body goes on, as a handle does, the rim
// crosses it at the height of the rim on both sides. The front is away from the centre of the box about the
// body; on a bowl without a handle, it is the end of the longer side at +x (or +z). Fails if the body has a
// mesh, and if nothing on it would hold water.
Result<Bowl> find_bowl(const Body& body, const Vector3& up);

}  // namespace spoonbill
