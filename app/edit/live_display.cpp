#include "app/edit/live_display.h"

#include <algorithm>
#include <cstdio>

#include "app/panel/rows.h"

namespace spoonbill {

void MessageLine::draw(const Theme& theme, const ImVec2& corner_px, double seconds) {
  while (shown_.size() > lines_limit) shown_.pop_front();
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

namespace {

constexpr float width_heights = 15.0F;  // width of a plot, in text heights
constexpr float plot_heights = 2.6F;    // height of a plot, in text heights

}  // namespace

void LivePlots::add(const std::vector<float>& forces_n, const LoopFigures& loop, double seconds) {
  for (const float force : forces_n) {
    forces_n_[next_force_] = force;
    next_force_ = (next_force_ + 1) % force_count;
  }
  loop_ = loop;
  since_rate_s_ += seconds;
  if (since_rate_s_ < rate_interval_s) return;
  since_rate_s_ = 0.0;
  rates_hz_[next_rate_] = static_cast<float>(loop.rate_hz);
  next_rate_ = (next_rate_ + 1) % rate_count;
}

void LivePlots::draw(const Theme& theme, const ImVec2& corner_px, double force_limit_n) const {
  ImGui::PushFont(theme.fonts.body);
  const float height = ImGui::GetTextLineHeight();
  const float gap = theme.metrics.padding_px;
  ImGui::SetNextWindowPos(ImVec2(corner_px.x - gap, corner_px.y + gap), ImGuiCond_Always, ImVec2(1.0F, 0.0F));
  ImGui::Begin("Plots", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoInputs);
  const ImVec2 size(width_heights * height, plot_heights * height);
  std::array<char, 64> text{};
  const float newest = forces_n_[(next_force_ + force_count - 1) % force_count];
  std::snprintf(text.data(), text.size(), "Force %.2f N, 2 s", static_cast<double>(newest));
  ImGui::TextColored(colour::quiet_ink, "%s", text.data());
  ImGui::PlotLines("##force", forces_n_.data(), static_cast<int>(force_count), static_cast<int>(next_force_),
                   nullptr, 0.0F, static_cast<float>(std::max(force_limit_n, 1e-3)), size);
  std::snprintf(text.data(), text.size(), "Rate %.0f Hz, 1 min, %llu missed", loop_.rate_hz,
                static_cast<unsigned long long>(loop_.missed));
  ImGui::TextColored(colour::quiet_ink, "%s", text.data());
  ImGui::PlotLines("##rate", rates_hz_.data(), static_cast<int>(rate_count), static_cast<int>(next_rate_),
                   nullptr, 0.0F, 1200.0F, size);
  ImGui::End();
  ImGui::PopFont();
}

}  // namespace spoonbill
