#include "engine/exchange/field_reader.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"

namespace spoonbill {

namespace {

constexpr std::size_t text_limit = 200;

// Largest deviation from unit length at which a direction is not scaled, so that it keeps its bits when it is
// written and read.
constexpr double unit_tolerance = 1e-12;

const Json& null_value() {
  static const Json value;
  return value;
}

}  // namespace

FieldReader::FieldReader(const Json& json, std::string source)
    : json_(&json), source_(std::move(source)), problem_(std::make_shared<std::optional<Error>>()) {
  if (!json.is_object()) refuse("is " + json_excerpt(json) + ", must be an object", ErrorCode::wrong_type);
}

FieldReader::FieldReader(const Json& json, const FieldReader& parent, std::string path)
    : json_(&json), source_(parent.source_), path_(std::move(path)), problem_(parent.problem_) {
  if (!json.is_object()) refuse("is " + json_excerpt(json) + ", must be an object", ErrorCode::wrong_type);
}

std::string FieldReader::path_to(std::string_view field) const {
  return path_.empty() ? std::string(field) : path_ + "." + std::string(field);
}

void FieldReader::refuse(std::string_view field, const std::string& message, ErrorCode code) {
  if (*problem_) return;
  const std::string path = path_to(field);
  *problem_ = Error{code, source_ + ": " + path + " " + message, path};
}

void FieldReader::refuse(const std::string& message, ErrorCode code) {
  if (*problem_) return;
  *problem_ = Error{code, source_ + ": " + (path_.empty() ? message : path_ + " " + message), path_};
}

void FieldReader::refuse(const Error& error) {
  refuse(error.message, error.code);
}

Status FieldReader::status() const {
  return *problem_ ? Status(**problem_) : Status();
}

bool FieldReader::has(std::string_view field) const {
  return json_->is_object() && json_->contains(std::string(field));
}

void FieldReader::ignore(std::string_view field) {
  if (std::find(known_fields_.begin(), known_fields_.end(), field) == known_fields_.end()) {
    known_fields_.emplace_back(field);
  }
}

const Json* FieldReader::find(std::string_view field) {
  ignore(field);
  if (*problem_) return nullptr;
  const auto found = json_->find(std::string(field));
  if (found != json_->end()) return &*found;
  refuse(field, "is missing", ErrorCode::missing);
  return nullptr;
}

void FieldReader::refuse_type(std::string_view field, const Json& value, const char* wanted) {
  refuse(field, "is " + json_excerpt(value) + ", must be " + wanted, ErrorCode::wrong_type);
}

void FieldReader::version(std::string_view field, int known) {
  version(field, Range<int>{known, known});
}

int FieldReader::version(std::string_view field, Range<int> known) {
  const Json* value = find(field);
  if (value == nullptr) return known.high;
  if (value->is_number_integer() && *value >= known.low && *value <= known.high) return value->get<int>();
  const bool newer = value->is_number_integer() && *value > known.high;
  const std::string forms = std::to_string(known.low) +
                            (known.low < known.high ? " to " + std::to_string(known.high) : std::string());
  refuse(
      field,
      "is " + json_excerpt(*value) + ", this program reads " + forms +
          (newer ? "; the file is from a newer program, update this one" : "; the file has no known version"),
      ErrorCode::unsupported);
  return known.high;
}

std::string FieldReader::text(std::string_view field) {
  const Json* value = find(field);
  if (value == nullptr) return {};
  if (!value->is_string()) {
    refuse_type(field, *value, "a text in quotes");
    return {};
  }
  const auto& text = value->get_ref<const std::string&>();
  const bool has_control =
      std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  if (text.size() > text_limit) {
    refuse(field, "is longer than " + std::to_string(text_limit) + " bytes; shorten it", ErrorCode::too_many);
  }
  if (has_control) refuse(field, "contains control characters; remove them", ErrorCode::malformed);
  return text;
}

bool FieldReader::boolean(std::string_view field) {
  const Json* value = find(field);
  if (value == nullptr) return false;
  if (!value->is_boolean()) {
    refuse_type(field, *value, "true or false");
    return false;
  }
  return value->get<bool>();
}

double FieldReader::read_component(std::string_view field, const Json& value, Range<double> range,
                                   bool is_length) {
  const std::optional<double> read =
      is_length ? length_from_json(value)
                : (value.is_number() ? std::optional(value.get<double>()) : std::nullopt);
  if (!read) {
    refuse_type(field, value, "a number");
    return range.low;
  }
  if (range.contains(*read)) return *read;
  const double scale = is_length ? 1000.0 : 1.0;
  refuse(field, "is " + json_excerpt(value) + ", must be from " + number_text(range.low * scale) + " to " +
                    number_text(range.high * scale));
  return range.low;
}

double FieldReader::number(std::string_view field, Range<double> range) {
  const Json* value = find(field);
  return value == nullptr ? range.low : read_component(field, *value, range, false);
}

double FieldReader::length_m(std::string_view field, Range<double> range_m) {
  const Json* value = find(field);
  return value == nullptr ? range_m.low : read_component(field, *value, range_m, true);
}

int FieldReader::integer(std::string_view field, Range<int> range) {
  const Range<double> wide{static_cast<double>(range.low), static_cast<double>(range.high)};
  const double value = number(field, wide);
  if (std::trunc(value) == value) return static_cast<int>(value);
  refuse(field, "is " + number_text(value) + ", must be a whole number");
  return range.low;
}

std::uint64_t FieldReader::unsigned_integer(std::string_view field, std::uint64_t limit) {
  const Json* value = find(field);
  if (value == nullptr) return 0;
  if (!value->is_number_unsigned() || value->get<std::uint64_t>() > limit) {
    refuse(field,
           "is " + json_excerpt(*value) + ", must be a whole number from 0 to " + std::to_string(limit));
    return 0;
  }
  return value->get<std::uint64_t>();
}

Vector3 FieldReader::read_components(std::string_view field, Range<double> range, bool are_lengths) {
  const Json* value = find(field);
  Vector3 vector = Vector3::Zero();
  if (value == nullptr) return vector;
  if (!value->is_array() || value->size() != 3) {
    refuse_type(field, *value, "a list of 3 numbers");
    return vector;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = std::string(field) + "[" + std::to_string(axis) + "]";
    vector[static_cast<Eigen::Index>(axis)] = read_component(name, (*value)[axis], range, are_lengths);
  }
  return vector;
}

Vector3 FieldReader::vector(std::string_view field, Range<double> range) {
  return read_components(field, range, false);
}

Vector3 FieldReader::position_m(std::string_view field, Range<double> range_m) {
  return read_components(field, range_m, true);
}

Vector3 FieldReader::direction(std::string_view field) {
  const Vector3 given = vector(field, {-1e6, 1e6});
  if (*problem_) return Vector3::UnitX();
  const double length = given.norm();
  if (length < 1e-6) {
    refuse(field, "is zero, must have a length", ErrorCode::degenerate);
    return Vector3::UnitX();
  }
  return std::abs(length - 1.0) <= unit_tolerance ? given : Vector3(given / length);
}

const Json& FieldReader::object(std::string_view field) {
  const Json* value = find(field);
  if (value == nullptr) return null_value();
  if (!value->is_object()) refuse_type(field, *value, "an object");
  return *value;
}

const Json& FieldReader::list(std::string_view field, Range<int> size) {
  const Json* value = find(field);
  if (value == nullptr) return null_value();
  const std::size_t low = static_cast<std::size_t>(size.low), high = static_cast<std::size_t>(size.high);
  if (value->is_array() && value->size() >= low && value->size() <= high) return *value;
  refuse(field,
         "is " + json_excerpt(*value) + ", must be a list of " + std::to_string(size.low) +
             (low == high ? "" : " to " + std::to_string(size.high)),
         !value->is_array() ? ErrorCode::wrong_type
                            : (value->size() < low ? ErrorCode::too_few : ErrorCode::too_many));
  return null_value();
}

std::size_t FieldReader::choose(std::string_view field, std::span<const char* const> names) {
  const Json* value = find(field);
  if (value == nullptr) return 0;
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (value->is_string() && value->get_ref<const std::string&>() == names[i]) return i;
    known += (i == 0 ? "" : " or ") + std::string(names[i]);
  }
  refuse(field, "is " + json_excerpt(*value) + ", must be " + known,
         value->is_string() ? ErrorCode::unknown : ErrorCode::wrong_type);
  return 0;
}

FieldReader FieldReader::inner(std::string_view field) {
  const Json* value = find(field);
  return {value == nullptr ? null_value() : *value, *this, path_to(field)};
}

FieldReader FieldReader::element(const Json& json, std::string_view list_field, std::size_t index) {
  return {json, *this, path_to(list_field) + "[" + std::to_string(index) + "]"};
}

void FieldReader::finish() {
  if (*problem_) return;
  for (const auto& item : json_->items()) {
    if (std::find(known_fields_.begin(), known_fields_.end(), item.key()) != known_fields_.end()) continue;
    std::string known;
    for (const std::string& field : known_fields_) known += (known.empty() ? "" : ", ") + field;
    const std::string about = source_ + ": " + (path_.empty() ? "" : path_ + " ");
    *problem_ = Error{ErrorCode::unknown,
                      about + "has an unknown field " + json_excerpt(Json(item.key())) +
                          (known.empty() ? "" : "; known: " + known),
                      path_to(item.key())};
    return;
  }
}

}  // namespace spoonbill
