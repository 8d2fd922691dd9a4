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
  InterfaceContext made(std::move(context), font_path);
  if (Status scaled = made.rescale(scale); !scaled) return scaled.error();
  return made;
}

Status InterfaceContext::rescale(double scale) {
  make_current();
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  const Metrics metrics = metrics_for(scale);
  auto fonts = add_interface_fonts(atlas, font_path_, metrics.body_px, metrics.heading_px);
  if (!fonts) return fonts.error();
  apply_theme(ImGui::GetStyle(), metrics);
  theme_ = Theme{metrics, fonts.value()};
  return {};
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
