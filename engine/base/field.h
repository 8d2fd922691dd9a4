// What the program knows of one field of a plain struct: its name in files, its range, its unit, whether it
// may be left out. A struct has one constexpr table of these beside it, and reading, writing, commands, the
// checks, the panel's sliders and the JSON schema all walk that table:
//
//   template <>
//   inline constexpr auto fields_of<FixingPlane> = std::to_array<Field<FixingPlane>>({
//       position_field("point_mm", &FixingPlane::point_m, "Any point of the plane"),
//       direction_field("normal", &FixingPlane::normal, "Away from what it holds"),
//   });
//
// Values are SI; files hold lengths in millimetres, and the field's name says so. The order of a table is
// that of the fields in files. Nothing here allocates but what makes a message.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

#include "engine/base/pose.h"
#include "engine/base/range.h"
#include "engine/base/result.h"

namespace spoonbill {

enum class FieldUnit {
  none,
  times,  // a factor
  metre,
  pascal,
  kilogram_per_m3,
  per_second,
  per_tick,
  second,
  hertz,
  newton,
  metre_per_s2
};

// What a vector is: three lengths; a direction, of which files may give any length; or a quantity.
enum class VectorSense { position, direction, quantity };

// How the panel offers a number: the range is what a hand can tell apart, within what the field allows.
struct FieldSlider {
  const char* label = nullptr;  // none: the panel does not offer it
  Range<double> range{0.0, 0.0};
  bool logarithmic = false;
};

// Another name that files may use instead of the field's, for a multiple of its value.
struct FieldAlias {
  const char* name = nullptr;
  double factor = 1.0;
  const char* help = "";
};

constexpr Range<int> whole(Range<double> range) {
  return {static_cast<int>(range.low), static_cast<int>(range.high)};
}

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

// All of a field but where it is in its struct.
struct FieldForm {
  const char* name = nullptr;  // as files say it
  const char* help = "";       // a phrase without a full stop; empty where the name says it all
  FieldUnit unit = FieldUnit::none;
  Range<double> range{-unlimited, unlimited};  // of a number, or of each component of a vector
  double length_limit = unlimited;             // of a vector
  VectorSense sense = VectorSense::quantity;   // of a vector
  // May be left out of files: it has its struct's default, and is written where it has another value.
  bool optional = false;
  // The optional field before it with which this one comes: required where that is given, unknown elsewhere.
  const char* partner = nullptr;
  FieldAlias alias = {};
  FieldSlider slider = {};
  std::span<const char* const> choices = {};  // of an enumeration, in the order of its values
};

// An enumeration whose values are 0, 1, 2, ...
template <class Object>
struct ChoiceMember {
  std::size_t (*get)(const Object&);
  void (*set)(Object&, std::size_t);
};

template <class Object>
struct Field {
  using Member = std::variant<std::string Object::*, bool Object::*, double Object::*, int Object::*,
                              std::uint32_t Object::*, Vector3 Object::*, ChoiceMember<Object>>;

  FieldForm form;
  Member member;
  // The range of this object's number where that depends on its other fields; of all objects where null.
  Range<double> (*range_by_object)(const Object&) = nullptr;
  // Whether this object has the field at all; null: every one has.
  bool (*applies_to)(const Object&) = nullptr;

  Range<double> range_for(const Object& object) const {
    return range_by_object == nullptr ? form.range : range_by_object(object);
  }
  bool applies(const Object& object) const { return applies_to == nullptr || applies_to(object); }

  // Each returns the field with one thing changed.
  constexpr Field optional() const {
    Field field = *this;
    field.form.optional = true;
    return field;
  }
  constexpr Field with_partner(const char* name) const {
    Field field = *this;
    field.form.partner = name;
    return field;
  }
  constexpr Field with_alias(FieldAlias alias) const {
    Field field = *this;
    field.form.alias = alias;
    return field;
  }
  constexpr Field with_slider(FieldSlider slider) const {
    Field field = *this;
    field.form.slider = slider;
    return field;
  }
  constexpr Field with_range_by(Range<double> (*range)(const Object&)) const {
    Field field = *this;
    field.range_by_object = range;
    return field;
  }
  constexpr Field only_if(bool (*applies)(const Object&)) const {
    Field field = *this;
    field.applies_to = applies;
    return field;
  }
};

// The table of a struct, specialised beside it.
struct NoFields {};
template <class Object>
inline constexpr NoFields fields_of;

// What files call one of several structs that may stand in the same place.
template <class Object>
inline constexpr const char* kind_name = nullptr;

// Of all alternatives of a variant, in its order.
template <class Variant>
inline constexpr auto kind_names = nullptr;
template <class... Alternatives>
inline constexpr auto kind_names<std::variant<Alternatives...>> =
    std::array<const char*, sizeof...(Alternatives)>{kind_name<Alternatives>...};

template <class Object>
constexpr Field<Object> text_field(const char* name, std::string Object::*member, const char* help = "") {
  return {{.name = name, .help = help}, member};
}

template <class Object>
constexpr Field<Object> switch_field(const char* name, bool Object::*member, const char* help = "") {
  return {{.name = name, .help = help}, member};
}

template <class Object>
constexpr Field<Object> number_field(const char* name, double Object::*member, Range<double> range,
                                     FieldUnit unit = FieldUnit::none, const char* help = "") {
  return {{.name = name, .help = help, .unit = unit, .range = range}, member};
}

// `Number` is int or std::uint32_t.
template <class Object, class Number>
constexpr Field<Object> whole_number_field(const char* name, Number Object::*member, Range<int> range,
                                           FieldUnit unit = FieldUnit::none, const char* help = "") {
  const Range<double> wide{static_cast<double>(range.low), static_cast<double>(range.high)};
  return {{.name = name, .help = help, .unit = unit, .range = wide}, member};
}

template <class Object>
constexpr Field<Object> position_field(const char* name, Vector3 Object::*member, const char* help = "") {
  return {{.name = name,
           .help = help,
           .unit = FieldUnit::metre,
           .range = position_range_m,
           .sense = VectorSense::position},
          member};
}

// Three lengths, each within the range.
template <class Object>
constexpr Field<Object> lengths_field(const char* name, Vector3 Object::*member, Range<double> range_m,
                                      const char* help = "") {
  return {{.name = name,
           .help = help,
           .unit = FieldUnit::metre,
           .range = range_m,
           .sense = VectorSense::position},
          member};
}

template <class Object>
constexpr Field<Object> direction_field(const char* name, Vector3 Object::*member, const char* help = "") {
  return {{.name = name, .help = help, .sense = VectorSense::direction}, member};
}

// No longer than the limit.
template <class Object>
constexpr Field<Object> vector_field(const char* name, Vector3 Object::*member, double limit, FieldUnit unit,
                                     const char* help = "") {
  return {{.name = name,
           .help = help,
           .unit = unit,
           .range = {-limit, limit},
           .length_limit = limit,
           .sense = unit == FieldUnit::metre ? VectorSense::position : VectorSense::quantity},
          member};
}

namespace detail {
template <class Member>
struct MemberParts;
template <class Value, class Owner>
struct MemberParts<Value Owner::*> {
  using Object = Owner;
  using Type = Value;
};
}  // namespace detail

// `member` is of an enumeration whose values are the places of their names.
template <auto member>
constexpr auto choice_field(const char* name, std::span<const char* const> names, const char* help = "") {
  using Parts = detail::MemberParts<decltype(member)>;
  using Object = typename Parts::Object;
  const ChoiceMember<Object> choice{
      [](const Object& object) { return static_cast<std::size_t>(object.*member); },
      [](Object& object, std::size_t value) { object.*member = static_cast<typename Parts::Type>(value); }};
  return Field<Object>{{.name = name, .help = help, .choices = names}, choice};
}

// The field of a struct's member; does not compile for one that the table lacks.
template <class Object, class Value>
consteval const Field<Object>& field_of(Value Object::*member) {
  for (const Field<Object>& field : fields_of<Object>) {
    const auto* found = std::get_if<Value Object::*>(&field.member);
    if (found != nullptr && *found == member) return field;
  }
  throw "the table of the struct has no such field";
}

// As the program's own messages call it: metres in the name of a length.
std::string name_in_si(const FieldForm& form);

// Each names the field, the value and the range; `about` stands before the name: "tool: ".
Status check_value(const std::string& about, const FieldForm& form, double value, Range<double> range);
Status check_value(const std::string& about, const FieldForm& form, int value, Range<double> range);
Status check_value(const std::string& about, const FieldForm& form, const Vector3& value);

// The first number or vector that is not within its range; nothing is asked of texts, switches and choices.
template <class Object>
Status check_fields(const std::string& about, const Object& object) {
  const auto check = [&](const Field<Object>& field, auto member) -> Status {
    using Member = decltype(member);
    if constexpr (std::is_same_v<Member, double Object::*> || std::is_same_v<Member, int Object::*>) {
      return check_value(about, field.form, object.*member, field.range_for(object));
    } else if constexpr (std::is_same_v<Member, Vector3 Object::*>) {
      return check_value(about, field.form, object.*member);
    } else if constexpr (std::is_same_v<Member, std::uint32_t Object::*>) {
      return check_value(about, field.form, static_cast<double>(object.*member), field.form.range);
    }
    return {};
  };
  for (const Field<Object>& field : fields_of<Object>) {
    if (!field.applies(object)) continue;
    const Status status = std::visit([&](auto member) { return check(field, member); }, field.member);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace spoonbill
