// The Dear ImGui context of one picture or window: fonts, theme and frame clock. It writes no settings file,
// and its clock advances 1/60 s a frame, so that the same frames always look the same (a window's backend
// tells it the true time instead). One owner; the thread
// that draws.
#pragma once

#include <imgui.h>

#include <memory>
#include <string>

#include "app/panel/theme.h"
#include "engine/base/result.h"

namespace spoonbill {

class InterfaceContext {
 public:
  // Refused: a font file that cannot be read.
  static Result<InterfaceContext> make(const std::string& font_path, double scale);

  // The same at another scale; the fonts must be uploaded again. Refused as make() does.
  Status rescale(double scale);

  // ImGui keeps the current context in a variable of its own: makes ours the current one.
  void make_current() const { ImGui::SetCurrentContext(context_.get()); }

  // Between the two, ImGui calls lay out one frame. The fonts must have been uploaded before the first. The
  // draw data is valid until the next begin_frame().
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
