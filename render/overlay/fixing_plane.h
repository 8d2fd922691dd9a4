// A fixing plane as a rectangle around what it cuts. No GL.
#pragma once

#include <array>
#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/overlay/line.h"

namespace spoonbill {

using PlaneCorners = std::array<Vector3, 4>;  // in order around the rectangle

// Upright, sized by the fixed nodes, which do not move while the rest bends; by the body's box where none are
// fixed.
PlaneCorners fixing_plane_corners(const PlaneSnapshot& plane, const std::vector<BodySnapshot>& bodies,
                                  const Box& body);

// The same around the body's box alone, larger than it by `overhang_share` of the larger side, on each side.
PlaneCorners corners_around(const PlaneSnapshot& plane, const Box& body, double overhang_share);

// Where the arrow along the plane's normal ends.
Vector3 plane_arrow_tip(const PlaneCorners& corners, const PlaneSnapshot& plane);

// Appends the rectangle's border and a short arrow along the normal, toward what stays free.
void append_plane_border(const PlaneCorners& corners, const PlaneSnapshot& plane,
                         std::vector<OverlayLine>& lines);

}  // namespace spoonbill
