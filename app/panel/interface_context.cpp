#include "app/panel/interface_context.h"

#include <utility>

namespace spoonbill {
namespace {

ImVec4 grey(float light) {
  return {light, light + 0.005F, light + 0.012F, 1.0F};
}

ImVec4 with_alpha(ImVec4 base, float alpha) {
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
  colours[ImGuiCol_SliderGrab] = with_alpha(colour::accent, 0.45F);
  colours[ImGuiCol_SliderGrabActive] = colour::accent;
  colours[ImGuiCol_CheckMark] = colour::accent;
  colours[ImGuiCol_Button] = colour::white;
  colours[ImGuiCol_ButtonHovered] = with_alpha(colour::accent, 0.15F);
  colours[ImGuiCol_ButtonActive] = with_alpha(colour::accent, 0.35F);
  colours[ImGuiCol_Header] = with_alpha(colour::accent, 0.15F);
  colours[ImGuiCol_HeaderHovered] = with_alpha(colour::accent, 0.25F);
  colours[ImGuiCol_Separator] = grey(0.84F);
  colours[ImGuiCol_PlotHistogram] = with_alpha(colour::accent, 0.45F);
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
  // ImGui rounds positions down to whole pixels, which reduces the height of rows at small scales. A larger
  // padding compensates for this loss.
  style.CellPadding = ImVec2(0.0F, (unit < 2.0F ? 1.75F : 1.25F) * unit);
  style.ScrollbarSize = 10.0F * unit;
  style.ScrollbarRounding = 3.0F * unit;
}

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
