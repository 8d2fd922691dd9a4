// The fields of a described struct (field.h) as JSON: what a document, a material file and a command hold of
// it. Reading and writing are inverse to each other, to the last bit.
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

// Whether the reader's object must have the field, or has what may be left out.
bool is_due(const FieldReader& reader, const FieldForm& form);

// One value; the reader keeps the first problem.
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

// All fields of the table, in its order; what files leave out stays as it is in `object`.
template <class Object>
void read_fields(FieldReader& reader, Object& object) {
  for (const Field<Object>& field : fields_of<Object>) {
    if (!field.applies(object) || !is_due(reader, field.form)) continue;
    const auto read = [&](auto member) {
      if constexpr (std::is_same_v<decltype(member), ChoiceMember<Object>>) {
        member.set(object, reader.choose(field.form.name, field.form.choices));
      } else {
        read_value(reader, field.form, field.range_for(object), object.*member);
      }
    };
    std::visit(read, field.member);
  }
}

template <class Object>
Object read_fields(FieldReader& reader) {
  Object object;
  read_fields(reader, object);
  return object;
}

// Those that files leave out only where they have another value than the struct's default.
template <class Object>
void add_fields(const Object& object, Json& json) {
  static const Object unset{};
  for (const Field<Object>& field : fields_of<Object>) {
    const FieldForm& form = field.form;
    if (!field.applies(object) || (form.partner != nullptr && !json.contains(form.partner))) continue;
    const auto add = [&](auto member) {
      if constexpr (std::is_same_v<decltype(member), ChoiceMember<Object>>) {
        json[form.name] = form.choices[member.get(object)];
      } else if (!form.optional || object.*member != unset.*member) {
        json[form.name] = value_to_json(form, object.*member);
      }
    };
    std::visit(add, field.member);
  }
}

// The alternative of a variant that stands at a place in kind_names, as it is by default.
template <class Variant>
Variant make_kind(std::size_t place) {
  return [&]<std::size_t... places>(std::index_sequence<places...>) {
    const Variant all[] = {Variant(std::in_place_index<places>)...};
    return all[place];
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
}

}  // namespace spoonbill
