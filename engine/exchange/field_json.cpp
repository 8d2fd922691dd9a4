#include "engine/exchange/field_json.h"

#include "engine/base/text.h"

namespace spoonbill {

bool is_field_expected(const FieldReader& reader, const FieldForm& form) {
  if (form.partner != nullptr) return reader.has(form.partner);
  return !form.optional || reader.has(form.name);
}

void read_value(FieldReader& reader, const FieldForm& form, Range<double>, std::string& value) {
  value = reader.text(form.name);
}

void read_value(FieldReader& reader, const FieldForm& form, Range<double>, bool& value) {
  value = reader.boolean(form.name);
}

void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, double& value) {
  value = form.unit == FieldUnit::metre ? reader.length_m(form.name, range) : reader.number(form.name, range);
}

void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, int& value) {
  value = reader.integer(form.name, whole(range));
}

void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, std::uint32_t& value) {
  value = static_cast<std::uint32_t>(reader.integer(form.name, whole(range)));
}

void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, Vector3& value) {
  if (form.sense == VectorSense::direction) {
    value = reader.direction(form.name);
    return;
  }
  const bool in_metres = form.unit == FieldUnit::metre;
  value = in_metres ? reader.position_m(form.name, range) : reader.vector(form.name, range);
  if (value.norm() > form.length_limit) {
    reader.refuse(form.name,
                  "must be no longer than " + number_text((in_metres ? 1e3 : 1.0) * form.length_limit));
  }
}

Json value_to_json(const FieldForm&, const std::string& value) {
  return value;
}

Json value_to_json(const FieldForm&, bool value) {
  return value;
}

Json value_to_json(const FieldForm& form, double value) {
  return form.unit == FieldUnit::metre ? length_to_json(value) : number_to_json(value);
}

Json value_to_json(const FieldForm&, int value) {
  return value;
}

Json value_to_json(const FieldForm&, std::uint32_t value) {
  return value;
}

Json value_to_json(const FieldForm& form, const Vector3& value) {
  Json json = Json::array();
  for (int axis = 0; axis < 3; ++axis) json.push_back(value_to_json(form, value[axis]));
  return json;
}

}  // namespace spoonbill
