// Reads the fields of one JSON object. The first problem sticks and names file, path and range; later reads
// return harmless values, so that the caller reads straight through and asks status() once at the end.
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

// Refers to the JSON it reads, which must outlive it. Readers of inner objects report to the outermost one.
class FieldReader {
 public:
  // `source` names the file (and line) in messages.
  FieldReader(const Json& json, std::string source);

  bool has(std::string_view field) const;

  // The number that says which form the file has; refused unless it is `known`, or in the range of those
  // known.
  void version(std::string_view field, int known);
  int version(std::string_view field, Range<int> known);

  // Each returns the field's value, or a harmless one after a problem. A missing field is a problem.
  std::string text(std::string_view field);  // at most 200 bytes, no control characters
  bool boolean(std::string_view field);
  double number(std::string_view field, Range<double> range);
  int integer(std::string_view field, Range<int> range);
  std::uint64_t unsigned_integer(std::string_view field, std::uint64_t limit);
  double length_m(std::string_view field, Range<double> range_m);
  Vector3 vector(std::string_view field, Range<double> range);
  Vector3 position_m(std::string_view field, Range<double> range_m);  // three lengths
  Vector3 direction(std::string_view field);  // not zero; scaled to length 1 unless it has it already
  const Json& object(std::string_view field);
  const Json& list(std::string_view field, Range<int> size);

  // The place of the value among the names.
  std::size_t choose(std::string_view field, std::span<const char* const> names);
  template <class Choice>
  Choice choice(std::string_view field, std::initializer_list<std::pair<const char*, Choice>> choices);

  // The reader of a field that is an object, and of an object in a list; finish() each.
  FieldReader inner(std::string_view field);
  FieldReader element(const Json& json, std::string_view list_field, std::size_t index);

  // A known field whose value the caller does not read.
  void ignore(std::string_view field);

  // Reports the fields that nobody asked for.
  void finish();

  // "FILE: path.field " and then the message.
  void refuse(std::string_view field, const std::string& message);
  // "FILE: path: message", about the object as a whole.
  void refuse(const std::string& message);

  Status status() const;

 private:
  FieldReader(const Json& json, const FieldReader& parent, std::string path);

  const Json* find(std::string_view field);
  std::string name_of(std::string_view field) const;
  void wrong_type(std::string_view field, const Json& value, const char* wanted);
  double component(std::string_view field, const Json& value, Range<double> range, bool is_length);
  Vector3 components(std::string_view field, Range<double> range, bool are_lengths);

  const Json* json_;
  std::string source_;
  std::string path_;
  std::vector<std::string> asked_;
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
