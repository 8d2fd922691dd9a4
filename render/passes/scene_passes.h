// All passes of a picture and their order: the shadow maps; the scene, with samples (what is opaque, what is
// translucent, the marks over it); then the frame, without (background, the ground's grid and shadows, and
// the scene laid over them). Ground lines are smooth by themselves and need no samples.
#pragma once

#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/simulation/snapshot.h"
#include "render/passes/background_pass.h"
#include "render/passes/body_meshes.h"
#include "render/passes/frame_view.h"
#include "render/passes/ground_pass.h"
#include "render/passes/line_pass.h"
#include "render/passes/mark_pass.h"
#include "render/passes/resolve_pass.h"
#include "render/passes/shadow_pass.h"
#include "render/passes/shell_pass.h"
#include "render/passes/solid_pass.h"
#include "render/passes/surface_pass.h"
#include "render/passes/tool_buffers.h"
#include "render/passes/triangle_pass.h"
#include "render/view_settings.h"

namespace spoonbill {

class ScenePasses {
 public:
  static Result<ScenePasses> make(const GlFunctions& gl);

  // Before a frame. The error is that of a solid tool that cannot be drawn.
  Status follow(const ToolSnapshot& tool) { return passes_.tool.update(tool); }

  // Before draw(), into maps of their own; nothing when shadows are off.
  void draw_shadows(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings,
                    const BodyMeshes& bodies);

  // Leaves the finished picture in the target's frame.
  void draw(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings,
            const BodyMeshes& bodies, const RenderTarget& target);

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
  void draw_overlays(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings);
  void draw_planes(const FrameView& view, const Snapshot& snapshot, const Box& body);
  void draw_symmetry(const FrameView& view, const Snapshot& snapshot, const Box& body);
  void draw_tools(const FrameView& view, const Snapshot& snapshot);
  void draw_tool(const FrameView& view, const ToolSnapshot& tool, const ToolFrame& frame);
  void draw_stage(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings) const;
  void draw_touched(const FrameView& view, const Snapshot& snapshot);

  Passes passes_;
  std::vector<OverlayLine> lines_;  // working memory, kept from frame to frame
  std::vector<OverlayMark> marks_;
};

}  // namespace spoonbill
