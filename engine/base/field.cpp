#include "engine/base/field.h"

#include <string_view>

namespace spoonbill {
namespace {

// Returns the status unchanged if it is ok. Otherwise returns its error with Error::field set to the name
// that the field has in files.
Status with_field(Status status, const FieldForm& form) {
  if (status.ok()) return status;
  return Error{status.error().code, status.error().message, form.name};
}

}  // namespace

std::string name_in_si(const FieldForm& form) {
  const std::string_view name = form.name;
  const bool in_millimetres = form.unit == FieldUnit::metre && name.ends_with("_mm");
  return in_millimetres ? std::string(name.substr(0, name.size() - 2)) + "m" : std::string(name);
}

// Builds the field's name only if the number is refused, because building it allocates. Valid numbers are
// also accepted between two ticks, where nothing may be allocated.
Status check_value(const std::string& about, const FieldForm& form, double value, Range<double> range) {
  if (range.contains(value)) return {};
  return with_field(check_range(about + name_in_si(form), value, range), form);
}

Status check_value(const std::string& about, const FieldForm& form, int value, Range<double> range) {
  if (whole(range).contains(value)) return {};
  return with_field(check_range(about + name_in_si(form), value, whole(range)), form);
}

Status check_value(const std::string& about, const FieldForm& form, const Vector3& value) {
  const std::string name = name_in_si(form);
  if (form.sense == VectorSense::direction) return with_field(check_unit(about + name, value), form);
  if (form.length_limit < unlimited) {
    const Range<double> lengths{0.0, form.length_limit};
    return with_field(check_range(about + "length of " + name, value.norm(), lengths), form);
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (form.range.contains(value[axis])) continue;
    const std::string component = about + name + "[" + std::to_string(axis) + "]";
    return with_field(check_range(component, value[axis], form.range), form);
  }
  return {};
}

}  // namespace spoonbill
