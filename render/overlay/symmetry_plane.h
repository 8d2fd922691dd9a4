// The plane of symmetry as a dash-dotted rectangle around the body, as drawings show one. No GL.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "render/overlay/fixing_plane.h"

namespace spoonbill {

PlaneCorners symmetry_plane_corners(const PlaneSnapshot& plane, const Box& body);

void append_symmetry_plane(const PlaneCorners& corners, std::vector<OverlayLine>& lines);

}  // namespace spoonbill
