#include "app/panel/rows.h"

#include <algorithm>
#include <array>

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

// What a quantity's row is: a slider, or a field to type in, which gets the keyboard a frame after it opens.
enum Entry : int { entry_closed, entry_opens, entry_open };

// Ctrl and a click turn the slider into a field, and do not move it.
bool slide(const FieldForm& form, const std::string& name, double& value, const std::string& text,
           int& entry) {
  const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat |
                                 ImGuiSliderFlags_NoInput |
                                 (form.slider.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
  double moved = value;
  const bool changed = ImGui::SliderScalar(name.c_str(), ImGuiDataType_Double, &moved, &form.slider.range.low,
                                           &form.slider.range.high, as_format(text).c_str(), flags);
  if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && ImGui::GetIO().KeyCtrl) {
    entry = entry_opens;
    return false;
  }
  if (changed) value = moved;
  return changed;
}

// Whether what now stands in the field was confirmed.
bool type_in(const std::string& name, std::array<char, 64>& text, int& entry) {
  if (entry == entry_opens) ImGui::SetKeyboardFocusHere();
  const bool confirmed =
      ImGui::InputText((name + "typed").c_str(), text.data(), text.size(),
                       ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_EnterReturnsTrue);
  if (ImGui::IsItemActive()) {
    entry = entry_open;
  } else if (entry == entry_open) {
    entry = entry_closed;
  }
  return confirmed;
}

// Of the row just begun, for an item of this width.
void put_at_right(float width) {
  ImGui::SameLine();
  const float room = ImGui::GetContentRegionAvail().x - width;
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(0.0F, room));
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

bool quantity_row(const FieldForm& form, double& value, const std::string& text, std::string& refusal) {
  begin_row(form.slider.label);
  const std::string name = hidden_name(form.slider.label);
  int* entry = ImGui::GetStateStorage()->GetIntRef(ImGui::GetID(name.c_str()), entry_closed);
  if (*entry == entry_closed) return slide(form, name, value, text, *entry);
  std::array<char, 64> typed{};
  text.copy(typed.data(), typed.size() - 1);
  if (!type_in(name, typed, *entry)) return false;
  const Result<double> read = read_quantity(form, typed.data(), text);
  if (!read.ok()) {
    refusal = read.error().message;
    return false;
  }
  value = read.value();
  return true;
}

bool slider_row(const FieldForm& form, int& value, const std::string& text) {
  const char* label = form.slider.label;
  const Range<int> range = whole(form.slider.range);
  begin_row(label);
  return ImGui::SliderInt(hidden_name(label).c_str(), &value, range.low, range.high, as_format(text).c_str(),
                          ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat);
}

bool choice_row(const char* label, int& chosen, std::span<const char* const> names) {
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

bool deed_row(const char* label, const std::string& text, const char* button) {
  fact_row(label, text);
  put_at_right(ImGui::CalcTextSize(button).x + 2.0F * ImGui::GetStyle().FramePadding.x);
  return ImGui::Button(button);
}

bool switch_row(const char* label, const std::string& text, const char* name, bool& on) {
  fact_row(label, text);
  put_at_right(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(name).x);
  return ImGui::Checkbox(name, &on);
}

void gauge_row(const char* label, double share, const std::string& text) {
  begin_row(label);
  const auto filled = static_cast<float>(std::clamp(share, 0.0, 1.0));
  ImGui::ProgressBar(filled, ImVec2(-FLT_MIN, ImGui::GetFrameHeight()), text.c_str());
}

}  // namespace spoonbill
