// Conversion between JSON and structs that have a table of fields (field.h). Reading and writing are inverse
// to each other, to the last bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "engine/base/field.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Returns true if the field must be read. If the form of a field names another field as its partner, the
// field is read if the partner is present. An optional field is read if it is present itself. Any other field
// is always read.
bool is_field_expected(const FieldReader& reader, const FieldForm& form);

// Each read_value() reads one value. A problem is stored in the reader.
void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, std::string& value);
void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, bool& value);
void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, double& value);
void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, int& value);
void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, std::uint32_t& value);
void read_value(FieldReader& reader, const FieldForm& form, Range<double> range, Vector3& value);

Json value_to_json(const FieldForm& form, const std::string& value);
Json value_to_json(const FieldForm& form, bool value);
Json value_to_json(const FieldForm& form, double value);
Json value_to_json(const FieldForm& form, int value);
Json value_to_json(const FieldForm& form, std::uint32_t value);
Json value_to_json(const FieldForm& form, const Vector3& value);

// Reads the fields in fields_of<Object>, in this order. A field that does not apply to the object is skipped.
// An optional field that is missing keeps its value in `object`.
template <class Object>
void read_fields(FieldReader& reader, Object& object) {
  for (const Field<Object>& field : fields_of<Object>) {
    if (!field.applies(object) || !is_field_expected(reader, field.form)) continue;
    const auto read = [&](auto member) {
      if constexpr (std::is_same_v<decltype(member), ChoiceMember<Object>>) {
        member.set(object, reader.choose(field.form.name, field.form.choices));
      } else {
        read_value(reader, field.form, field.range_for(object), object.*member);
      }
    };
    field.member.visit(read);
  }
}

template <class Object>
Object read_fields(FieldReader& reader) {
  Object object;
  read_fields(reader, object);
  return object;
}

// Writes the fields in fields_of<Object> into `json`. A field that does not apply to the object is skipped.
// An optional field is written only if its value differs from the struct's default.
template <class Object>
void add_fields(const Object& object, Json& json) {
  static const Object default_object{};
  for (const Field<Object>& field : fields_of<Object>) {
    const FieldForm& form = field.form;
    if (!field.applies(object) || (form.partner != nullptr && !json.contains(form.partner))) continue;
    const auto add = [&](auto member) {
      if constexpr (std::is_same_v<decltype(member), ChoiceMember<Object>>) {
        if (form.optional && member.get(object) == member.get(default_object)) return;
        json[form.name] = form.choices[member.get(object)];
      } else if (!form.optional || object.*member != default_object.*member) {
        json[form.name] = value_to_json(form, object.*member);
      }
    };
    field.member.visit(add);
  }
}

// Returns a variant that holds its alternative number `index`, with default values.
template <class Variant>
Variant make_kind(std::size_t index) {
  return [&]<std::size_t... indices>(std::index_sequence<indices...>) {
    const Variant all[] = {Variant(std::in_place_index<indices>)...};
    return all[index];
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
}

}  // namespace spoonbill
