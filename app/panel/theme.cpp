#include "app/panel/theme.h"

namespace spoonbill {
namespace {

ImVec4 grey(float light) {
  return {light, light + 0.005F, light + 0.012F, 1.0F};
}

ImVec4 see_through(ImVec4 base, float alpha) {
  return {base.x, base.y, base.z, alpha};
}

void apply_colours(ImGuiStyle& style) {
  ImGui::StyleColorsLight(&style);
  auto& colours = style.Colors;
  colours[ImGuiCol_Text] = colour::ink;
  colours[ImGuiCol_TextDisabled] = colour::quiet_ink;
  colours[ImGuiCol_WindowBg] = grey(0.965F);
  colours[ImGuiCol_Border] = grey(0.80F);
  colours[ImGuiCol_FrameBg] = colour::white;
  colours[ImGuiCol_FrameBgHovered] = grey(0.985F);
  colours[ImGuiCol_FrameBgActive] = grey(0.94F);
  colours[ImGuiCol_SliderGrab] = see_through(colour::accent, 0.45F);
  colours[ImGuiCol_SliderGrabActive] = colour::accent;
  colours[ImGuiCol_CheckMark] = colour::accent;
  colours[ImGuiCol_Button] = colour::white;
  colours[ImGuiCol_ButtonHovered] = see_through(colour::accent, 0.15F);
  colours[ImGuiCol_ButtonActive] = see_through(colour::accent, 0.35F);
  colours[ImGuiCol_Header] = see_through(colour::accent, 0.15F);
  colours[ImGuiCol_HeaderHovered] = see_through(colour::accent, 0.25F);
  colours[ImGuiCol_Separator] = grey(0.84F);
  colours[ImGuiCol_PlotHistogram] = see_through(colour::accent, 0.45F);
}

}  // namespace

Metrics metrics_for(double scale) {
  const auto scaled = [scale](double px) { return static_cast<float>(px * scale); };
  return {scaled(15), scaled(18), scaled(300), scaled(92), scaled(12), scaled(2)};
}

void apply_theme(ImGuiStyle& style, const Metrics& metrics) {
  style = ImGuiStyle();
  apply_colours(style);
  const float unit = metrics.padding_px / 12.0F;
  style.WindowPadding = ImVec2(metrics.padding_px, 0.75F * metrics.padding_px);
  style.WindowRounding = 0.0F;
  style.WindowBorderSize = 0.0F;
  style.FramePadding = ImVec2(6.0F * unit, 1.0F * unit);
  style.FrameRounding = 3.0F * unit;
  style.FrameBorderSize = 1.0F;
  style.GrabRounding = 2.0F * unit;
  style.GrabMinSize = 9.0F * unit;
  style.ItemSpacing = ImVec2(6.0F * unit, metrics.row_gap_px);
  style.ItemInnerSpacing = ImVec2(6.0F * unit, 4.0F * unit);
  style.CellPadding = ImVec2(0.0F, 1.75F * unit);
  style.ScrollbarSize = 10.0F * unit;
  style.ScrollbarRounding = 3.0F * unit;
}

}  // namespace spoonbill
