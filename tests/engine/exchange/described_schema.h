// Builds the JSON schema of structs that have tables of fields (field.h). "text", "length_mm", "point_mm",
// "vector" and "region" refer to definitions in the schema of documents.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "engine/base/field.h"
#include "engine/exchange/json.h"

namespace spoonbill {

inline Json definition(const char* name) {
  return {{"$ref", "#/$defs/" + std::string(name)}};
}

inline Json number_schema(const char* type, Range<double> range) {
  Json json{{"type", type}};
  if (std::isfinite(range.low)) json["minimum"] = number_to_json(range.low);
  if (std::isfinite(range.high)) json["maximum"] = number_to_json(range.high);
  return json;
}

template <class Object, class Member>
Json value_schema(const FieldForm& form, Member) {
  if constexpr (std::is_same_v<Member, std::string Object::*>) {
    return definition("text");
  } else if constexpr (std::is_same_v<Member, bool Object::*>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_same_v<Member, double Object::*>) {
    return form.unit == FieldUnit::metre ? definition("length_mm") : number_schema("number", form.range);
  } else if constexpr (std::is_same_v<Member, Vector3 Object::*>) {
    return definition(form.sense == VectorSense::position ? "point_mm" : "vector");
  } else if constexpr (std::is_same_v<Member, ChoiceMember<Object>>) {
    Json json;
    for (const char* name : form.choices) json["enum"].push_back(name);
    return json;
  } else {
    return number_schema("integer", form.range);
  }
}

inline Json with_help(const std::string& help, Json json) {
  if (help.empty()) return json;
  Json described{{"description", help + "."}};
  described.update(json);
  return described;
}

inline void append(Json& list, Json item) {
  if (list.is_null()) list = Json::array();
  list.push_back(std::move(item));
}

// Adds the requirements of a field to the schema of its object.
inline void require(const FieldForm& form, Json& object) {
  if (form.partner != nullptr) {
    object["dependentRequired"][form.partner] = Json::array({form.name});
    object["dependentRequired"][form.name] = Json::array({form.partner});
  } else if (!form.optional) {
    append(object["required"], form.name);
  }
}

// Returns the schema of an object. Its properties are those of `first`, which are all required, then the
// table's fields that apply to `object`.
template <class Object>
Json object_schema(const Object& object, const Json& first = Json::object()) {
  Json json{{"type", "object"}, {"required", Json::array()}};
  Json properties = Json::object();
  for (const auto& [name, property] : first.items()) {
    append(json["required"], name);
    properties[name] = property;
  }
  for (const Field<Object>& field : fields_of<Object>) {
    const FieldForm& form = field.form;
    if (!field.applies(object)) continue;
    if (!properties.contains(form.name)) require(form, json);
    const Json value = field.member.visit([&](auto member) { return value_schema<Object>(form, member); });
    if (!properties.contains(form.name)) properties[form.name] = with_help(form.help, value);
  }
  json["additionalProperties"] = false;
  json["properties"] = properties;
  return json;
}

// Returns one schema per value of the choice that is the struct's first field.
template <class Object>
Json choice_schema() {
  const Field<Object>& choice = fields_of<Object>.front();
  Json json;
  for (std::size_t value = 0; value < choice.form.choices.size(); ++value) {
    Object object;
    choice.member.visit([&](auto member) {
      if constexpr (std::is_same_v<decltype(member), ChoiceMember<Object>>) member.set(object, value);
    });
    const Json kind{{"const", choice.form.choices[value]}};
    append(json["oneOf"], object_schema(object, {{choice.form.name, kind}}));
  }
  return json;
}

// Returns one schema per alternative of the variant; the field `name_field` states which alternative applies.
// The schema of a region is taken from the schema of documents, because a region has no table of
// fields (fields_of()).
template <class Variant>
Json variant_schema(const char* name_field) {
  Json json;
  const auto add = [&]<class Kind>(const Kind& kind) {
    Json first{{name_field, {{"const", kind_name<Kind>}}}};
    if constexpr (requires { kind.region; }) first["region"] = definition("region");
    append(json["oneOf"], object_schema(kind, first));
  };
  [&]<std::size_t... places>(std::index_sequence<places...>) {
    (add(std::variant_alternative_t<places, Variant>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
  return json;
}

}  // namespace spoonbill
