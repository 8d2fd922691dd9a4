// The rows that the panel is made of: a label in the left column, a value or widget in the right one. To be
// called between InterfaceContext::begin_frame() and end_frame(). Widgets return whether the person changed
// the value.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/panel/quantity.h"
#include "app/panel/theme.h"
#include "engine/base/field.h"

namespace spoonbill {

// A group of rows under a heading, open as long as the object lives.
class RowGroup {
 public:
  RowGroup(const char* heading, const Theme& theme);
  ~RowGroup();
  RowGroup(const RowGroup&) = delete;
  RowGroup& operator=(const RowGroup&) = delete;

  explicit operator bool() const { return open_; }

 private:
  bool open_;
};

// A field with a slider. `text` is what the slider shows for the value it has now. With Ctrl and a click a
// value can be typed, as read_quantity() takes it; where that refuses, the value stays and `refusal` says
// why.
bool quantity_row(const FieldForm& form, double& value, const std::string& text, std::string& refusal);
bool slider_row(const FieldForm& form, int& value, const std::string& text);

// One of a few choices side by side.
bool choice_row(const char* label, int& chosen, std::span<const char* const> names);

// One of many, in a list that opens.
bool list_row(const char* label, int& chosen, const std::vector<const char*>& names);

void fact_row(const char* label, const std::string& text);

// A fact and what can be done about it: whether the button was pressed.
bool deed_row(const char* label, const std::string& text, const char* button);

// A fact and what can be switched on about it: whether it was switched.
bool switch_row(const char* label, const std::string& text, const char* name, bool& on);

// A bar that fills from 0 to 1.
void gauge_row(const char* label, double share, const std::string& text);

}  // namespace spoonbill
