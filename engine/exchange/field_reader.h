// Reader of the fields of one JSON object. The first problem is stored; its message names file, path and
// range. Later reads return harmless values, so that the caller can read all fields and check status() once
// at the end.
//
//   FieldReader reader(json, "spoon.json");
//   tool.radius_m = reader.length_m("radius_mm", tool_radius_range_m);
//   reader.finish();
//   if (!reader.status().ok()) return reader.status().error();
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Reader of one JSON object, which must outlive the reader. Copies of a reader, and the readers of inner
// objects, share the stored problem.
class FieldReader {
 public:
  // `source` names the file (and line) in messages.
  FieldReader(const Json& json, std::string source);

  bool has(std::string_view field) const;

  // version() reads the version number of the file's format and refuses a version outside `known`. The second
  // overload returns the version number.
  void version(std::string_view field, int known);
  int version(std::string_view field, Range<int> known);

  // Each of these functions returns the field's value, or a harmless value after a problem. A missing field
  // is a problem.
  std::string text(std::string_view field);  // at most 200 bytes, no control characters
  bool boolean(std::string_view field);
  double number(std::string_view field, Range<double> range);
  int integer(std::string_view field, Range<int> range);
  std::uint64_t unsigned_integer(std::string_view field, std::uint64_t limit);
  double length_m(std::string_view field, Range<double> range_m);
  Vector3 vector(std::string_view field, Range<double> range);
  Vector3 position_m(std::string_view field, Range<double> range_m);  // a list of three lengths
  // Reads a vector that is not zero, and scales it to length 1 unless it already has this length.
  Vector3 direction(std::string_view field);
  const Json& object(std::string_view field);
  const Json& list(std::string_view field, Range<int> size);

  // Returns the index in `names` of the field's text.
  std::size_t choose(std::string_view field, std::span<const char* const> names);
  // Returns the choice that belongs to the field's text.
  template <class Choice>
  Choice choice(std::string_view field, std::initializer_list<std::pair<const char*, Choice>> choices);

  // inner() returns the reader of a field that is an object; element() returns the reader of an object in a
  // list. Call finish() on each reader.
  FieldReader inner(std::string_view field);
  FieldReader element(const Json& json, std::string_view list_field, std::size_t index);

  // Marks a field as known although its value is not read.
  void ignore(std::string_view field);

  // Refuses fields that were neither read nor ignored.
  void finish();

  // Stores the problem "FILE: path.field message", unless a problem is stored already. The member
  // Error::field of the stored error is "path.field".
  void refuse(std::string_view field, const std::string& message, ErrorCode code = ErrorCode::out_of_range);
  // Stores the problem "FILE: path message" about the object as a whole, unless one is stored already.
  void refuse(const std::string& message, ErrorCode code = ErrorCode::inconsistent);
  // Stores an error about the object's content with its code, unless a problem is stored already.
  void refuse(const Error& error);

  Status status() const;

 private:
  FieldReader(const Json& json, const FieldReader& parent, std::string path);

  const Json* find(std::string_view field);
  std::string path_to(std::string_view field) const;
  void refuse_type(std::string_view field, const Json& value, const char* wanted);
  double read_component(std::string_view field, const Json& value, Range<double> range, bool is_length);
  Vector3 read_components(std::string_view field, Range<double> range, bool are_lengths);

  const Json* json_;
  std::string source_;
  // Path of the object within the file; empty for the outermost object.
  std::string path_;
  std::vector<std::string> known_fields_;  // fields in the order in which they were first read
  std::shared_ptr<std::optional<Error>> problem_;
};

template <class Choice>
Choice FieldReader::choice(std::string_view field,
                           std::initializer_list<std::pair<const char*, Choice>> choices) {
  std::vector<const char*> names;
  for (const auto& [name, value] : choices) names.push_back(name);
  return (choices.begin() + choose(field, names))->second;
}

}  // namespace spoonbill
