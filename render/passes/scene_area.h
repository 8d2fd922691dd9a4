// The part of the picture that the scene can touch: with four samples, clearing and resolving empty pixels
// would cost more than drawing the model. No GL.
#pragma once

#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/gl/render_target.h"
#include "render/view_settings.h"

namespace spoonbill {

// Around body, tool, force arrow, fixing planes, lattice and what else is on, with room for marks; the whole
// viewport when any of it lies behind the eye.
PixelArea scene_area(const Snapshot& snapshot, const ViewSettings& settings, const Viewport& viewport,
                     const BoundingBox& body);

}  // namespace spoonbill
