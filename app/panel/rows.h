// Rows of the panel: a label in the left column, a value or widget in the right one. The functions must be
// called between InterfaceContext::begin_frame() and end_frame(). Functions of widgets return true if the
// user changed the value.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/panel/interface_context.h"
#include "engine/base/field.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the number with this many decimals, followed by `unit`.
std::string rounded_text(double number, int decimals, const char* unit);

// Returns a number with its unit, as a slider shows it: "1.20 MPa", "0.45", "4.0 /s".
std::string quantity_text(const FieldForm& form, double value);

// Parses a typed number with an optional unit and returns it in SI units. The default unit is the one in
// `shown`, the text that the user replaces. An unknown unit, text that is not a number, and a value out of
// range are errors that name the units or the range.
Result<double> read_quantity(const FieldForm& form, const std::string& typed, const std::string& shown);

// A checkbox beside a heading. `on` must not be null.
struct HeadingSwitch {
  const char* name;
  bool* on;
};

// A group of rows under a heading, open for the lifetime of the object.
class RowGroup {
 public:
  // Draws the switches at the right end of the heading's line, from left to right.
  RowGroup(const char* heading, const Theme& theme, std::span<const HeadingSwitch> switches = {});
  ~RowGroup();
  RowGroup(const RowGroup&) = delete;
  RowGroup& operator=(const RowGroup&) = delete;

  explicit operator bool() const { return open_; }

 private:
  bool open_;
};

// Adds a slider with this text for the current value. Ctrl+click turns the slider into a text field, which
// read_quantity() parses. On an error the value is unchanged and `refusal` is the message.
bool quantity_row(const FieldForm& form, double& value, const std::string& text, std::string& refusal);
bool slider_row(const FieldForm& form, int& value, const std::string& text);

// Adds radio buttons side by side, for a few choices.
bool choice_row(const char* label, int& chosen, std::span<const char* const> names);

// Adds a drop-down list, for many choices.
bool list_row(const char* label, int& chosen, const std::vector<const char*>& names);

// Adds a line of text.
void fact_row(const char* label, const std::string& text);

// Adds a line of text with a button. Returns true if the button was pressed.
bool button_row(const char* label, const std::string& text, const char* button);

// Adds a line of text with a checkbox. Returns true if it was toggled.
bool switch_row(const char* label, const std::string& text, const char* name, bool& on);

// Adds a bar that is filled by `fraction`, 0 to 1.
void gauge_row(const char* label, double fraction, const std::string& text);
// Adds a bar as gauge_row() does, and a named checkbox beside it. Returns true if the user changed `on`.
bool gauge_switch_row(const char* label, double fraction, const std::string& text, const char* name,
                      bool& on);

}  // namespace spoonbill
