// All passes of a picture and their order.
//
//   shadow maps
//   scene, with samples:     opaque bodies and force, translucent bodies, overlays, planes, tool,
//                            contact stage, touched nodes
//   frame, without samples:  background, ground with grid and shadows, resolved scene, scale bar
//
// The lines of the ground grid have smooth edges themselves and need no samples.
#pragma once

#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/gl/render_target.h"
#include "render/passes/frame_passes.h"
#include "render/passes/frame_view.h"
#include "render/passes/mesh_buffers.h"
#include "render/passes/overlay_passes.h"
#include "render/passes/shadow_pass.h"
#include "render/passes/surface_passes.h"
#include "render/view_settings.h"

namespace spoonbill {

// Returns the part of the picture that the scene can cover, as disjoint vertical strips with a margin for
// marks. The strips enclose bodies, tool and overlays. If any point is behind the eye, one strip covers the
// whole viewport. With four samples per pixel, clearing and resolving empty pixels would take as long as
// drawing the model. Defined in scene_area.cpp.
std::vector<PixelArea> scene_area(const Snapshot& snapshot, const ViewSettings& settings,
                                  const FrameView& view, const std::vector<TessellatedSurface>& bodies);

class ScenePasses {
 public:
  static Result<ScenePasses> make(const GlFunctions& gl);

  // Updates the mesh of the tool. Call before each frame. Returns the error of a solid tool that cannot be
  // drawn.
  Status update_tool(const ToolSnapshot& tool) { return passes_.tool.update(tool); }

  // Chooses how the bodies are drawn, and makes the programs that this needs. Call before draw().
  Status prepare(const Snapshot& snapshot, const ViewSettings& settings);

  // Draws the shadow maps; does nothing if shadows are off. Call before draw().
  void draw_shadows(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings,
                    const BodyMeshes& bodies);

  // Draws the complete picture into the target's frame. `scene_view` is the view in pixels of the scene
  // layer.
  void draw(const FrameView& view, const FrameView& scene_view, const Snapshot& snapshot,
            const ViewSettings& settings, const BodyMeshes& bodies, const RenderTarget& target);

 private:
  struct Passes {
    BackgroundPass background;
    GroundPass ground;
    ShadowPass shadow;
    SurfacePass surface;
    SolidPass solid;
    LinePass line;
    MarkPass mark;
    ShellPass shell;
    TrianglePass triangle;
    ResolvePass resolve;
    ToolBuffers tool;
  };
  explicit ScenePasses(Passes passes) : passes_(std::move(passes)) {}

  void draw_scene(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings,
                  const BodyMeshes& bodies);
  void draw_ground(const FrameView& view, const ViewSettings& settings);
  void draw_scale_bar(const FrameView& view, const ViewSettings& settings);
  void draw_force(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings) const;
  void draw_rings(const FrameView& view, const Snapshot& snapshot, const BodyMeshes& bodies);
  void draw_overlays(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings);
  void draw_planes(const FrameView& view, const Snapshot& snapshot, const Box& body);
  void draw_symmetry(const FrameView& view, const Snapshot& snapshot, const Box& body);
  void draw_tools(const FrameView& view, const Snapshot& snapshot);
  void draw_tool(const FrameView& view, const ToolSnapshot& tool, const ToolFrame& frame);
  void draw_stage(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings) const;
  void draw_goal(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings);
  void draw_touched(const FrameView& view, const Snapshot& snapshot);

  Passes passes_;
  std::vector<SurfaceDrawing> drawings_;  // of the bodies of the snapshot
  std::vector<OverlayLine> lines_;        // working memory, reused from frame to frame
  std::vector<OverlayMark> marks_;
};

}  // namespace spoonbill
