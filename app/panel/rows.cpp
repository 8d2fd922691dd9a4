#include "app/panel/rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <span>
#include <string_view>

#include "app/report/quantity_text.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// A unit and its size in SI units; the name is empty for a pure number.
struct QuantityUnit {
  std::string_view name;
  double size = 1.0;
};

constexpr std::array<QuantityUnit, 3> lengths = {{{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}}};
constexpr std::array<QuantityUnit, 4> moduli = {{{"Pa", 1.0}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}};
constexpr std::array<QuantityUnit, 4> densities = {
    {{"g/cm\u00b3", 1e3}, {"g/cm3", 1e3}, {"kg/m\u00b3", 1.0}, {"kg/m3", 1.0}}};
constexpr std::array<QuantityUnit, 1> pure_number = {{{"", 1.0}}};
constexpr std::array<QuantityUnit, 1> rates = {{{"/s", 1.0}}};
constexpr std::array<QuantityUnit, 2> factors = {{{"\u00d7", 1.0}, {"x", 1.0}}};

std::span<const QuantityUnit> find_units(FieldUnit unit) {
  switch (unit) {
    case FieldUnit::metre:
      return lengths;
    case FieldUnit::pascal:
      return moduli;
    case FieldUnit::kilogram_per_m3:
      return densities;
    case FieldUnit::per_second:
      return rates;
    case FieldUnit::times:
      return factors;
    default:
      return pure_number;
  }
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// A number and the text after it.
struct Reading {
  double number = 0.0;
  std::string_view unit;
  bool is_number = false;
};

Reading read_number(std::string_view text) {
  text = trimmed(text);
  Reading reading;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), reading.number);
  reading.is_number = error == std::errc{};
  reading.unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  return reading;
}

const QuantityUnit* find_unit(const FieldForm& form, std::string_view name) {
  for (const QuantityUnit& unit : find_units(form.unit)) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

std::string text_in_unit(double value, const QuantityUnit& unit) {
  return number_text(value / unit.size) + (unit.name.empty() ? "" : " ") + std::string(unit.name);
}

Error unknown_unit(const FieldForm& form, std::string_view name) {
  std::string known;
  for (const QuantityUnit& unit : find_units(form.unit)) {
    known += (known.empty() ? "" : ", ") + std::string(unit.name.empty() ? "none" : unit.name);
  }
  return Error{
      ErrorCode::unknown,
      std::string(form.slider.label) + ": unit " + std::string(name) + " is unknown; units: " + known,
      std::string(form.name)};
}

}  // namespace

std::string rounded_text(double number, int decimals, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f%s", decimals, number, unit);
  return text.data();
}

std::string quantity_text(const FieldForm& form, double value) {
  switch (form.unit) {
    case FieldUnit::metre:
      return millimetres_text(value);
    case FieldUnit::pascal:
      return modulus_text(value);
    case FieldUnit::kilogram_per_m3:
      return density_text(value);
    case FieldUnit::per_second:
      return rounded_text(value, 1, " /s");
    case FieldUnit::times:
      return rounded_text(value, 2, " \u00d7");
    default:
      return rounded_text(value, 2, "");
  }
}

Result<double> read_quantity(const FieldForm& form, const std::string& typed, const std::string& shown) {
  const std::string field = form.slider.label;
  const Reading reading = read_number(typed);
  if (!reading.is_number) {
    return Error{ErrorCode::malformed, field + ": \"" + typed + "\" is not a number", std::string(form.name)};
  }
  const std::string_view name = reading.unit.empty() ? read_number(shown).unit : reading.unit;
  const QuantityUnit* unit = find_unit(form, name);
  if (unit == nullptr) return unknown_unit(form, name);
  const double value = reading.number * unit->size;
  if (!form.range.contains(value)) {
    return Error{ErrorCode::out_of_range,
                 field + " is " + text_in_unit(value, *unit) + ", must be from " +
                     text_in_unit(form.range.low, *unit) + " to " + text_in_unit(form.range.high, *unit),
                 std::string(form.name)};
  }
  return value;
}

namespace {

void begin_row(const char* label) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(colour::quiet_ink, "%s", label);
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-FLT_MIN);
}

// Returns an ImGui name without visible text; the label is in the left column.
std::string hidden_name(const char* label) {
  return std::string("##") + label;
}

// Escapes percent signs for a parameter that ImGui reads as a format.
std::string as_format(const std::string& text) {
  std::string format;
  for (const char letter : text) format += letter == '%' ? std::string("%%") : std::string(1, letter);
  return format;
}

// State of a quantity row. `closed`: a slider. `opens`: a text field that has just appeared and receives the
// keyboard focus. `open`: a text field that has the focus.
enum Entry : int { entry_closed, entry_opens, entry_open };

// Draws the slider. Ctrl+click opens the text field and leaves the value unchanged.
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

// Draws the text field. Returns true if its text was confirmed.
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

// Moves the cursor so that an item of this width ends at the right edge of the row.
void align_right(float width) {
  ImGui::SameLine();
  const float room = ImGui::GetContentRegionAvail().x - width;
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(0.0F, room));
}

}  // namespace

namespace {

void draw_switches(std::span<const HeadingSwitch> switches) {
  const ImGuiStyle& style = ImGui::GetStyle();
  // Without padding, the checkboxes are no higher than the heading.
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(style.FramePadding.x, 0.0F));
  float width = 0.0F;
  for (const HeadingSwitch& each : switches) {
    width += ImGui::GetFrameHeight() + style.ItemInnerSpacing.x + ImGui::CalcTextSize(each.name).x;
    if (&each != &switches.back()) width += style.ItemSpacing.x;
  }
  for (const HeadingSwitch& each : switches) {
    if (&each == &switches.front()) {
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width);
    } else {
      ImGui::SameLine();
    }
    ImGui::Checkbox(each.name, each.on);
  }
  ImGui::PopStyleVar();
}

}  // namespace

RowGroup::RowGroup(const char* heading, const Theme& theme, std::span<const HeadingSwitch> switches) {
  ImGui::Dummy(ImVec2(0.0F, 0.1F * theme.metrics.heading_px));
  ImGui::PushFont(theme.fonts.heading);
  ImGui::TextUnformatted(heading);
  ImGui::PopFont();
  draw_switches(switches);
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

bool button_row(const char* label, const std::string& text, const char* button) {
  fact_row(label, text);
  align_right(ImGui::CalcTextSize(button).x + 2.0F * ImGui::GetStyle().FramePadding.x);
  return ImGui::Button(button);
}

bool switch_row(const char* label, const std::string& text, const char* name, bool& on) {
  fact_row(label, text);
  align_right(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(name).x);
  return ImGui::Checkbox(name, &on);
}

namespace {

// Draws a row with a bar. As in ImGui, a negative `width` leaves that much space at the right.
void draw_gauge(const char* label, double fraction, const std::string& text, float width) {
  begin_row(label);
  const auto filled = static_cast<float>(std::clamp(fraction, 0.0, 1.0));
  ImGui::ProgressBar(filled, ImVec2(width, ImGui::GetFrameHeight()), text.c_str());
}

}  // namespace

void gauge_row(const char* label, double fraction, const std::string& text) {
  draw_gauge(label, fraction, text, -FLT_MIN);
}

bool gauge_switch_row(const char* label, double fraction, const std::string& text, const char* name,
                      bool& on) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float box_width = ImGui::GetFrameHeight() + style.ItemInnerSpacing.x + ImGui::CalcTextSize(name).x;
  draw_gauge(label, fraction, text, -(box_width + style.ItemSpacing.x));
  ImGui::SameLine();
  return ImGui::Checkbox(name, &on);
}

}  // namespace spoonbill
