// Draws the Dear ImGui interface in any GL context.
//
// Large opaque rectangles, such as the panel's background, are cleared instead of drawn: without a GPU,
// blending textured triangles takes many times as long.
//
// The packaged ImGui backend is not used: it loads its functions from libGL, which an offscreen context does
// not use. The program owns the ImGui context; this pass does not access it.
#pragma once

#include <imgui.h>

#include "engine/base/result.h"
#include "render/gl/pipeline.h"

namespace spoonbill {

class ImGuiPass {
 public:
  // The function table must outlive the pass.
  static Result<ImGuiPass> make(const GlFunctions& gl);

  // Builds the atlas if necessary and uploads it as the font texture. Call again whenever fonts change,
  // before the next ImGui::NewFrame().
  void upload_fonts(ImFontAtlas& atlas);

  // Draws into the bound framebuffer, whose size in pixels is DisplaySize * FramebufferScale. Colours are
  // blended unchanged, in sRGB.
  void draw(const ImDrawData& data) const;

 private:
  ImGuiPass(const GlFunctions& gl, Program program);
  void set_state(const ImDrawData& data) const;
  void draw_list(const ImDrawData& data, const ImDrawList& list) const;
  void draw_command(const ImDrawData& data, const ImDrawList& list, const ImDrawCmd& command) const;

  const GlFunctions* gl_;
  Program program_;
  GlHandle vertex_array_;
  GlHandle vertices_;
  GlHandle indices_;
  GlHandle atlas_;
  ImVec2 white_;  // position of a white texel in the atlas
};

}  // namespace spoonbill
