#include "app/edit/message_line.h"

namespace spoonbill {

void MessageLine::draw(const Theme& theme, const ImVec2& corner_px, double seconds) {
  while (shown_.size() > most_lines) shown_.pop_front();
  for (Shown& shown : shown_) shown.seconds_left -= seconds;
  while (!shown_.empty() && shown_.front().seconds_left <= 0.0) shown_.pop_front();
  if (shown_.empty()) return;
  ImGui::PushFont(theme.fonts.body);
  const float gap = theme.metrics.padding_px;
  ImGui::SetNextWindowPos(ImVec2(corner_px.x + gap, corner_px.y - gap), ImGuiCond_Always, ImVec2(0.0F, 1.0F));
  ImGui::Begin("Messages", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  for (const Shown& shown : shown_) {
    const bool problem = shown.notice.kind == Notice::Kind::problem;
    ImGui::TextColored(problem ? colour::warning : colour::ink, "%s", shown.notice.text.c_str());
  }
  ImGui::End();
  ImGui::PopFont();
}

}  // namespace spoonbill
