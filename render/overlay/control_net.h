// A surface's control net as thin lines with a diamond at each control point. No GL.
#pragma once

#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/overlay/line.h"
#include "render/overlay/mark.h"

namespace spoonbill {

// Rows and columns of the net, closed where a direction is periodic.
void append_control_net(const SurfaceSnapshot& surface, std::vector<OverlayLine>& lines,
                        std::vector<OverlayMark>& marks);

}  // namespace spoonbill
