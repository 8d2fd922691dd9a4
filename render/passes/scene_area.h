// The part of the picture that the scene can touch: with four samples, clearing and resolving empty pixels
// would cost as much as drawing the model. No GL.
#pragma once

#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/gl/render_target.h"
#include "render/passes/frame_view.h"
#include "render/tessellation/tessellated_surface.h"
#include "render/view_settings.h"

namespace spoonbill {

// Upright strips, none over another: around bodies, tool, force arrow, fixing planes, lattice and what else
// is on, with room for marks. One for the whole viewport when anything lies behind the eye.
std::vector<PixelArea> scene_area(const Snapshot& snapshot, const ViewSettings& settings,
                                  const FrameView& view, const std::vector<TessellatedSurface>& bodies);

}  // namespace spoonbill
