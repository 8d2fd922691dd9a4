#include "engine/base/field.h"

#include <string_view>

namespace spoonbill {

std::string name_in_si(const FieldForm& form) {
  const std::string_view name = form.name;
  const bool in_millimetres = form.unit == FieldUnit::metre && name.ends_with("_mm");
  return in_millimetres ? std::string(name.substr(0, name.size() - 2)) + "m" : std::string(name);
}

// Names are made of what is refused alone: a tool is set between two ticks, where nothing is allocated.
Status check_value(const std::string& about, const FieldForm& form, double value, Range<double> range) {
  if (range.contains(value)) return {};
  return check_range(about + name_in_si(form), value, range);
}

Status check_value(const std::string& about, const FieldForm& form, int value, Range<double> range) {
  if (whole(range).contains(value)) return {};
  return check_range(about + name_in_si(form), value, whole(range));
}

Status check_value(const std::string& about, const FieldForm& form, const Vector3& value) {
  const std::string name = name_in_si(form);
  if (form.sense == VectorSense::direction) return check_unit(about + name, value);
  if (form.length_limit < unlimited) {
    return check_range(about + "length of " + name, value.norm(), Range<double>{0.0, form.length_limit});
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (form.range.contains(value[axis])) continue;
    const std::string component = about + name + "[" + std::to_string(axis) + "]";
    if (Status status = check_range(component, value[axis], form.range); !status.ok()) return status;
  }
  return {};
}

}  // namespace spoonbill
