#include "app/edit/lump_prompt.h"

#include <imgui.h>

#include <utility>

namespace spoonbill {
namespace {

const char* const title = "Begin with a lump";

}  // namespace

void LumpPrompt::ask() {
  asking_ = appearing_ = true;
  problem_.clear();
}

void LumpPrompt::refuse(std::string problem) {
  asking_ = appearing_ = true;
  problem_ = std::move(problem);
}

void LumpPrompt::draw_fields() {
  const StockShapeKind& kind = stock_shape_kinds()[choice_.kind];
  if (ImGui::BeginCombo("Kind", kind.name)) {
    for (std::size_t k = 0; k < stock_shape_kinds().size(); ++k) {
      if (ImGui::Selectable(stock_shape_kinds()[k].name, k == choice_.kind)) choice_ = default_stock_shape(k);
    }
    ImGui::EndCombo();
  }
  const StockShapeKind& chosen = stock_shape_kinds()[choice_.kind];
  for (std::size_t f = 0; f < chosen.fields.size(); ++f) {
    ImGui::InputDouble(chosen.fields[f].name, &choice_.sizes_mm[f], 0.0, 0.0, "%.4g mm");
  }
}

std::optional<LumpChoice> LumpPrompt::draw() {
  if (!asking_) return std::nullopt;
  if (appearing_) ImGui::OpenPopup(title);
  appearing_ = false;
  const ImVec2 middle(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal(title, nullptr,
                              ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    return std::nullopt;
  }
  ImGui::PushItemWidth(10.0F * ImGui::GetFontSize());
  draw_fields();
  ImGui::PopItemWidth();
  if (!problem_.empty()) {
    ImGui::PushTextWrapPos(24.0F * ImGui::GetFontSize());
    ImGui::TextUnformatted(problem_.c_str());
    ImGui::PopTextWrapPos();
  }
  std::optional<LumpChoice> result;
  const bool entered = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false);
  if (ImGui::Button("Begin") || entered) {
    result = choice_;
    asking_ = false;
  }
  ImGui::SameLine();
  if (ImGui::Button("Cancel")) asking_ = false;
  if (!asking_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return result;
}

}  // namespace spoonbill
