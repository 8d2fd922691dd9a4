#include "app/edit/prompts.h"

#include <imgui.h>

#include <utility>

namespace spoonbill {

std::optional<int> Question::draw() {
  if (!asking_) return std::nullopt;
  if (appearing_) ImGui::OpenPopup(title_);
  appearing_ = false;
  const ImVec2 middle(0.5F * ImGui::GetIO().DisplaySize.x, 0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal(title_, nullptr,
                              ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings)) {
    return std::nullopt;
  }
  ImGui::TextUnformatted(text_.c_str());
  std::optional<int> answer;
  for (int i = 0; i < 3; ++i) {
    if (answers_[i] == nullptr) continue;
    if (i > 0) ImGui::SameLine();
    if (ImGui::Button(answers_[i])) answer = i;
  }
  if (answer) asking_ = false;
  if (!asking_) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return answer;
}

}  // namespace spoonbill
