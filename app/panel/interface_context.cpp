#include "app/panel/interface_context.h"

#include <utility>

namespace spoonbill {

Result<InterfaceContext> InterfaceContext::make(const std::string& font_path, double scale) {
  std::unique_ptr<ImGuiContext, Destroy> context(ImGui::CreateContext());
  ImGui::SetCurrentContext(context.get());
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.DeltaTime = 1.0F / 60.0F;
  const Metrics metrics = metrics_for(scale);
  auto fonts = add_interface_fonts(*io.Fonts, font_path, metrics.body_px, metrics.heading_px);
  if (!fonts) return fonts.error();
  apply_theme(ImGui::GetStyle(), metrics);
  return InterfaceContext(std::move(context), Theme{metrics, fonts.value()});
}

void InterfaceContext::begin_frame(int width_px, int height_px) {
  make_current();
  ImGui::GetIO().DisplaySize = ImVec2(static_cast<float>(width_px), static_cast<float>(height_px));
  ImGui::NewFrame();
}

const ImDrawData& InterfaceContext::end_frame() {
  ImGui::Render();
  return *ImGui::GetDrawData();
}

ImFontAtlas& InterfaceContext::fonts() const {
  make_current();
  return *ImGui::GetIO().Fonts;
}

}  // namespace spoonbill
