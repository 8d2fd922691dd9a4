// The Dear ImGui context of a picture or window: font, theme and frame clock.
#pragma once

#include <imgui.h>

#include <memory>
#include <string>

#include "engine/base/result.h"
#include "render/renderer.h"

namespace spoonbill {

// The interface's font, as Debian's package fonts-roboto-unhinted installs it.
inline constexpr const char* font_file =
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf";

// Lengths of the interface, in pixels at its scale.
struct Metrics {
  float body_px;
  float heading_px;
  float panel_width_px;
  float label_width_px;
  float padding_px;
  float row_gap_px;
};

// Lengths and fonts of the interface.
struct Theme {
  Metrics metrics;
  InterfaceFonts fonts;
};

namespace colour {
inline const ImVec4 ink{0.13F, 0.15F, 0.18F, 1.0F};
inline const ImVec4 quiet_ink{0.42F, 0.45F, 0.49F, 1.0F};
inline const ImVec4 accent{0.16F, 0.42F, 0.60F, 1.0F};
inline const ImVec4 warning{0.74F, 0.30F, 0.06F, 1.0F};
inline const ImVec4 white{1.0F, 1.0F, 1.0F, 1.0F};
}  // namespace colour

Metrics metrics_for(double scale);
void apply_theme(ImGuiStyle& style, const Metrics& metrics);

// Owns a Dear ImGui context. It writes no settings file. Its clock advances 1/60 s per frame, so that equal
// frames look equal; a window's backend sets the true time instead. One owner: the thread that draws.
class InterfaceContext {
 public:
  // Returns an error if the font file cannot be read.
  static Result<InterfaceContext> make(const std::string& font_path, double scale);

  // Changes the scale; the fonts must be uploaded afterwards. Returns an error as make() does.
  Status rescale(double scale);

  // Makes this context ImGui's current one, which ImGui stores in a global variable.
  void make_current() const { ImGui::SetCurrentContext(context_.get()); }

  // begin_frame() and end_frame() begin and end a frame; the ImGui calls between them lay it out. The fonts
  // must be uploaded before the first frame. The draw data is valid until the next begin_frame().
  void begin_frame(int width_px, int height_px);
  const ImDrawData& end_frame();

  ImFontAtlas& fonts() const;
  const Theme& theme() const { return theme_; }

 private:
  struct Destroy {
    void operator()(ImGuiContext* context) const { ImGui::DestroyContext(context); }
  };
  InterfaceContext(std::unique_ptr<ImGuiContext, Destroy> context, std::string font_path)
      : context_(std::move(context)), font_path_(std::move(font_path)) {}

  std::unique_ptr<ImGuiContext, Destroy> context_;
  std::string font_path_;
  Theme theme_{};
};

}  // namespace spoonbill
