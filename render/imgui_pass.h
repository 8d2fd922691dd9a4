// Draws what Dear ImGui laid out, in any GL context: the packaged backend finds its functions in libGL, which
// an offscreen context does not use. The ImGui context belongs to the program; nothing here touches it.
#pragma once

#include <imgui.h>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/program.h"

namespace spoonbill {

class ImGuiPass {
 public:
  // The function table must outlive the pass.
  static Result<ImGuiPass> make(const GlFunctions& gl);

  // Builds the atlas where that is still to do and makes it the texture of its letters. Call again whenever
  // fonts changed, before the next ImGui::NewFrame().
  void upload_fonts(ImFontAtlas& atlas);

  // Draws into the bound framebuffer, whose size in pixels is DisplaySize * FramebufferScale. Colours are
  // blended as given, in sRGB.
  void draw(const ImDrawData& data) const;

 private:
  ImGuiPass(const GlFunctions& gl, Program program);
  void set_state(const ImDrawData& data) const;
  void draw_list(const ImDrawData& data, const ImDrawList& list) const;

  const GlFunctions* gl_;
  Program program_;
  GlHandle vertex_array_;
  GlHandle vertices_;
  GlHandle indices_;
  GlHandle atlas_;
};

}  // namespace spoonbill
