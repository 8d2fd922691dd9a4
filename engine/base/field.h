// Descriptions of the fields of a plain struct: name in files, range, unit, and whether the field is
// optional. Each struct has one constexpr table beside it. Reading, writing, commands, checks, sliders of the
// panel and the JSON schema all iterate over that table:
//
//   template <>
//   inline constexpr auto fields_of<FixingPlane> = std::to_array<Field<FixingPlane>>({
//       position_field("point_mm", &FixingPlane::point_m, "Any point of the plane"),
//       direction_field("normal", &FixingPlane::normal, "Points away from the fixed side"),
//   });
//
// Values are in SI units, except that files store lengths in millimetres, in fields whose names end in "_mm".
// Fields appear in files in the order of the table. Checks of numbers allocate only for an error message.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

enum class FieldUnit {
  none,
  times,  // dimensionless factor
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

// Meaning of a vector: a position or another vector of three lengths; a direction, which files may give with
// any length; or any other quantity, such as a force.
enum class VectorSense { position, direction, quantity };

// Slider of a number in the panel. The slider's range is a part of the field's range that is narrow enough to
// set a value by hand.
struct FieldSlider {
  const char* label = nullptr;  // null: the panel has no slider for the field
  Range<double> range{0.0, 0.0};
  bool logarithmic = false;
};

// Returns the range with its ends converted to int.
constexpr Range<int> whole(Range<double> range) {
  return {static_cast<int>(range.low), static_cast<int>(range.high)};
}

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

// Properties of a field that do not depend on the type of its struct.
struct FieldForm {
  const char* name = nullptr;  // name in files
  const char* help = "";       // a phrase without a full stop; empty if the name is self-explanatory
  FieldUnit unit = FieldUnit::none;
  Range<double> range{-unlimited, unlimited};  // range of a number, or of each component of a vector
  double length_limit = unlimited;             // largest length of a vector
  VectorSense sense = VectorSense::quantity;   // meaning of a vector
  // True if files may omit the field. A missing field then has the default value of its struct, and the field
  // is written only if it differs from that default.
  bool optional = false;
  // Name of a partner: an optional field earlier in the table. If a file contains the partner, this field is
  // required; otherwise it is not accepted.
  const char* partner = nullptr;
  FieldSlider slider = {};
  std::span<const char* const> choices = {};  // names of an enumeration's values, in their order
};

// Functions that get and set a member of an enumeration type as a number. The values of the enumeration are
// 0, 1, 2, ...
template <class Object>
struct ChoiceMember {
  std::size_t (*get)(const Object&);
  void (*set)(Object&, std::size_t);
};

// A pointer to a member of a struct, or a ChoiceMember. It is stored in a union, because a std::variant would
// be instantiated for each struct in every source that includes a table, which makes compilation slower.
template <class Object>
class FieldMember {
 public:
  constexpr FieldMember(std::string Object::*member) : kind_(Kind::text), text_(member) {}
  constexpr FieldMember(bool Object::*member) : kind_(Kind::flag), flag_(member) {}
  constexpr FieldMember(double Object::*member) : kind_(Kind::number), number_(member) {}
  constexpr FieldMember(int Object::*member) : kind_(Kind::whole_number), whole_number_(member) {}
  constexpr FieldMember(std::uint32_t Object::*member) : kind_(Kind::count), count_(member) {}
  constexpr FieldMember(Vector3 Object::*member) : kind_(Kind::vector), vector_(member) {}
  constexpr FieldMember(ChoiceMember<Object> member) : kind_(Kind::choice), choice_(member) {}

  // Calls `visitor` with the pointer to the member, or with the ChoiceMember.
  template <class Visitor>
  constexpr decltype(auto) visit(Visitor&& visitor) const {
    switch (kind_) {
      case Kind::text:
        return visitor(text_);
      case Kind::flag:
        return visitor(flag_);
      case Kind::number:
        return visitor(number_);
      case Kind::whole_number:
        return visitor(whole_number_);
      case Kind::count:
        return visitor(count_);
      case Kind::vector:
        return visitor(vector_);
      case Kind::choice:
        break;
    }
    return visitor(choice_);
  }

  // Returns the pointer to the member if the member is a `Value`, otherwise null.
  template <class Value>
  constexpr Value Object::*pointer_to() const {
    Value Object::*found = nullptr;
    visit([&](auto member) {
      if constexpr (std::is_same_v<decltype(member), Value Object::*>) found = member;
    });
    return found;
  }

 private:
  enum class Kind { text, flag, number, whole_number, count, vector, choice };
  Kind kind_;
  union {
    std::string Object::*text_;
    bool Object::*flag_;
    double Object::*number_;
    int Object::*whole_number_;
    std::uint32_t Object::*count_;
    Vector3 Object::*vector_;
    ChoiceMember<Object> choice_;
  };
};

template <class Object>
struct Field {
  FieldForm form;
  FieldMember<Object> member;
  // Function that returns the range of a number, for a range that depends on other fields of the object; null
  // if the range is fixed.
  Range<double> (*range_by_object)(const Object&) = nullptr;
  // Function that returns true if an object has this field; null if every object has it.
  bool (*applies_to)(const Object&) = nullptr;

  Range<double> range_for(const Object& object) const {
    return range_by_object == nullptr ? form.range : range_by_object(object);
  }
  bool applies(const Object& object) const { return applies_to == nullptr || applies_to(object); }

  // Returns a copy of this field that is marked as optional. Each function below also returns a copy with one
  // property changed.
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

// fields_of<Object> is the table of a struct's fields. It is specialised beside the struct; NoFields marks a
// struct without a table.
struct NoFields {};
template <class Object>
inline constexpr NoFields fields_of;

// Name that files use for a struct that is an alternative of a std::variant; null for other structs.
template <class Object>
inline constexpr const char* kind_name = nullptr;

// Names (kind_name) of all alternatives of a std::variant, in the order of the variant.
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

// Describes a field that holds a whole number; `Number` must be int or std::uint32_t.
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

// Describes a field that holds a vector of three lengths, each within the range.
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

// Describes a field that holds a vector whose length is at most `limit`.
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

// Describes a field that holds an enumeration whose values are indices into `names`.
template <auto member>
constexpr auto choice_field(const char* name, std::span<const char* const> names, const char* help = "") {
  using Parts = detail::MemberParts<decltype(member)>;
  using Object = typename Parts::Object;
  const ChoiceMember<Object> choice{
      [](const Object& object) { return static_cast<std::size_t>(object.*member); },
      [](Object& object, std::size_t value) { object.*member = static_cast<typename Parts::Type>(value); }};
  return Field<Object>{{.name = name, .help = help, .choices = names}, choice};
}

// Returns the entry of fields_of<Object> for a member of the struct. The call does not compile if the table
// has no such entry.
template <class Object, class Value>
consteval const Field<Object>& field_of(Value Object::*member) {
  for (const Field<Object>& field : fields_of<Object>) {
    if (field.member.template pointer_to<Value>() == member) return field;
  }
  throw "the table of the struct has no such field";
}

// Returns the name under which messages report the field in SI units, such as "radius_m" for "radius_mm".
std::string name_in_si(const FieldForm& form);

// Returns an error if the value is outside its range or, for a direction, is not a unit vector. The message
// starts with `about`, such as "tool: ", and states the field's name in SI units, the value and what is
// required. Error::field is the name that the field has in files.
Status check_value(const std::string& about, const FieldForm& form, double value, Range<double> range);
Status check_value(const std::string& about, const FieldForm& form, int value, Range<double> range);
Status check_value(const std::string& about, const FieldForm& form, const Vector3& value);

// Returns an error for the object's first number or vector that check_value() refuses. Texts, switches and
// choices always pass.
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
    const Status status = field.member.visit([&](auto member) { return check(field, member); });
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace spoonbill
