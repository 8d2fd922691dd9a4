#include "app/panel/rows.h"

#include <algorithm>

namespace spoonbill {
namespace {

void begin_row(const char* label) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(colour::quiet_ink, "%s", label);
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-FLT_MIN);
}

// The label stands in the left column; the widget needs it as a name only.
std::string hidden_name(const char* label) {
  return std::string("##") + label;
}

// ImGui takes a format, in which a percent sign means something.
std::string as_format(const std::string& text) {
  std::string format;
  for (const char letter : text) format += letter == '%' ? std::string("%%") : std::string(1, letter);
  return format;
}

}  // namespace

RowGroup::RowGroup(const char* heading, const Theme& theme) {
  ImGui::Dummy(ImVec2(0.0F, 0.1F * theme.metrics.heading_px));
  ImGui::PushFont(theme.fonts.heading);
  ImGui::TextUnformatted(heading);
  ImGui::PopFont();
  ImGui::Separator();
  open_ = ImGui::BeginTable(heading, 2, ImGuiTableFlags_SizingFixedFit);
  if (!open_) return;
  ImGui::TableSetupColumn("label", ImGuiTableColumnFlags_WidthFixed, theme.metrics.label_width_px);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
}

RowGroup::~RowGroup() {
  if (open_) ImGui::EndTable();
}

bool slider_row(const char* label, double& value, Range<double> range, SliderScale scale,
                const std::string& text) {
  begin_row(label);
  const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat |
                                 (scale == SliderScale::logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
  return ImGui::SliderScalar(hidden_name(label).c_str(), ImGuiDataType_Double, &value, &range.low,
                             &range.high, as_format(text).c_str(), flags);
}

bool slider_row(const char* label, int& value, Range<int> range, const std::string& text) {
  begin_row(label);
  return ImGui::SliderInt(hidden_name(label).c_str(), &value, range.low, range.high, as_format(text).c_str(),
                          ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat);
}

bool choice_row(const char* label, int& chosen, std::initializer_list<const char*> names) {
  begin_row(label);
  bool changed = false;
  int index = 0;
  for (const char* name : names) {
    if (index > 0) ImGui::SameLine();
    changed |= ImGui::RadioButton(name, &chosen, index++);
  }
  return changed;
}

bool list_row(const char* label, int& chosen, const std::vector<const char*>& names) {
  begin_row(label);
  return ImGui::Combo(hidden_name(label).c_str(), &chosen, names.data(), static_cast<int>(names.size()));
}

void fact_row(const char* label, const std::string& text) {
  begin_row(label);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text.c_str());
}

void gauge_row(const char* label, double share, const std::string& text) {
  begin_row(label);
  const auto filled = static_cast<float>(std::clamp(share, 0.0, 1.0));
  ImGui::ProgressBar(filled, ImVec2(-FLT_MIN, ImGui::GetFrameHeight()), text.c_str());
}

}  // namespace spoonbill
