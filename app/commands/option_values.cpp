#include "app/commands/option_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/scans/number_lines.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

constexpr std::size_t table_bytes_limit = std::size_t{16} << 20;
constexpr std::size_t table_row_limit = 100000;
constexpr double coordinate_limit_m = 100.0;

std::optional<int> parse_whole_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

struct NumberAndRest {
  double number = 0.0;
  std::string_view rest;
};

std::optional<NumberAndRest> parse_leading_number(std::string_view text) {
  NumberAndRest result;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.number);
  if (error != std::errc() || !std::isfinite(result.number)) return {};
  result.rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return result;
}

std::optional<double> parse_length_m(std::string_view text) {
  const auto length = parse_leading_number(text);
  if (!length) return {};
  if (length->rest.empty() && length->number == 0.0) return 0.0;
  const auto unit = find_length_unit(length->rest);
  return unit ? std::optional(length->number * unit->metres) : std::nullopt;
}

std::optional<double> parse_plain_number(std::string_view text) {
  const auto number = parse_leading_number(text);
  return number && number->rest.empty() ? std::optional(number->number) : std::nullopt;
}

// Returns the parts between commas, or nothing if there are not `count` of them.
template <std::size_t count>
std::optional<std::array<std::string_view, count>> split_exactly(std::string_view text) {
  std::array<std::string_view, count> parts;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (k + 1 == count)) return {};
    parts[k] = text.substr(0, comma);
    if (k + 1 < count) text.remove_prefix(comma + 1);
  }
  return parts;
}

// Returns the parts between separators, without spaces and tabs at their ends.
std::vector<std::string_view> split_and_trim(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    std::string_view part = text.substr(0, at);
    while (!part.empty() && (part.front() == ' ' || part.front() == '\t')) part.remove_prefix(1);
    while (!part.empty() && (part.back() == ' ' || part.back() == '\t')) part.remove_suffix(1);
    parts.push_back(part);
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

// Parses a number that fills the whole text; a leading plus is ignored.
template <class Number>
std::optional<Number> parse_table_number(std::string_view text) {
  Number number{};
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string expected_header(const std::vector<std::string>& columns, bool with_section) {
  std::string text = with_section ? "section," : "";
  for (const std::string& column : columns) text += column + "_mm" + (&column == &columns.back() ? "" : ",");
  return text;
}

// Returns the unit of each column in metres, or nothing if the names are not the expected ones.
std::optional<std::vector<double>> parse_header(std::vector<std::string_view> names,
                                                const std::vector<std::string>& columns, bool with_section) {
  if (with_section) {
    if (names.empty() || names[0] != "section") return std::nullopt;
    names.erase(names.begin());
  }
  if (names.size() != columns.size()) return std::nullopt;
  std::vector<double> units;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::string start = columns[k] + "_";
    if (!names[k].starts_with(start)) return std::nullopt;
    const auto unit = find_length_unit(names[k].substr(start.size()));
    if (!unit) return std::nullopt;
    units.push_back(unit->metres);
  }
  return units;
}

// Builds a PointTable line by line.
class TableReader {
 public:
  TableReader(const std::string& source, const std::vector<std::string>& columns, bool with_section)
      : source_(source), columns_(columns), with_section_(with_section) {}

  Status add_line(std::string_view line) {
    ++line_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto parts = split_and_trim(line, ',');
    if (parts.size() == 1 && parts[0].empty()) return {};
    if (parts[0].starts_with('#')) return {};
    if (units_.empty()) {
      const auto units = parse_header(parts, columns_, with_section_);
      if (!units) {
        return error_at_line(ErrorCode::malformed, "names the columns '" + excerpt(line) +
                                                       "'; they must be " +
                                                       expected_header(columns_, with_section_) +
                                                       ", or the same with the unit cm, m or in (inches)");
      }
      units_ = *units;
      return {};
    }
    return add_row(parts);
  }

  Result<PointTable> finish() && {
    if (table_.rows_m.empty()) return Error{ErrorCode::too_few, source_ + ": contains no points"};
    return std::move(table_);
  }

 private:
  Error error_at_line(ErrorCode code, const std::string& message, const std::string& field = {}) const {
    return Error{code, source_ + ":" + std::to_string(line_) + ": " + message, field};
  }

  Status add_row(std::vector<std::string_view> parts) {
    const std::size_t wanted = columns_.size() + (with_section_ ? 1 : 0);
    if (parts.size() != wanted) {
      return error_at_line(ErrorCode::malformed, "has " + std::to_string(parts.size()) +
                                                     " values, must have " + std::to_string(wanted));
    }
    if (table_.rows_m.size() >= table_row_limit) {
      return error_at_line(ErrorCode::too_many, "is beyond the limit of " + std::to_string(table_row_limit) +
                                                    " points; remove some");
    }
    if (with_section_) {
      const auto section = parse_table_number<int>(parts[0]);
      if (!section) {
        return error_at_line(ErrorCode::malformed,
                             "section '" + excerpt(parts[0]) + "' is not a whole number", "section");
      }
      table_.sections.push_back(*section);
      parts.erase(parts.begin());
    }
    std::vector<double> row;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto number = parse_table_number<double>(parts[k]);
      if (!number || !(std::abs(*number * units_[k]) <= coordinate_limit_m)) {
        return error_at_line(
            number ? ErrorCode::out_of_range : ErrorCode::malformed,
            columns_[k] + " is '" + excerpt(parts[k]) + "', must be a number of at most 100 m", columns_[k]);
      }
      row.push_back(*number * units_[k]);
    }
    table_.rows_m.push_back(std::move(row));
    return {};
  }

  const std::string& source_;
  const std::vector<std::string>& columns_;
  bool with_section_;
  std::size_t line_ = 0;
  std::vector<double> units_;  // metres per unit of each column; empty until the header is read
  PointTable table_;
};

}  // namespace

Result<Extent> parse_extent(std::string_view text, Range<int> range, const char* example) {
  const std::size_t cross = text.find('x');
  const auto width = parse_whole_number(text.substr(0, cross));
  const auto height =
      cross == std::string_view::npos ? std::nullopt : parse_whole_number(text.substr(cross + 1));
  if (!width || !height || !range.contains(*width) || !range.contains(*height)) {
    return Error{width && height ? ErrorCode::out_of_range : ErrorCode::malformed,
                 "'" + excerpt(text) + "' is not two numbers like " + example + ", each from " +
                     std::to_string(range.low) + " to " + std::to_string(range.high)};
  }
  return Extent{*width, *height};
}

Result<double> parse_length(std::string_view text, Range<double> range_m) {
  const auto length = parse_length_m(text);
  if (!length) {
    return Error{ErrorCode::malformed,
                 "'" + excerpt(text) + "' is not a length with a unit, like 5mm (mm, cm, m or in)"};
  }
  if (!range_m.contains(*length)) {
    return Error{ErrorCode::out_of_range, "'" + excerpt(text) + "' must be from " + length_text(range_m.low) +
                                              " to " + length_text(range_m.high)};
  }
  return *length;
}

Result<double> parse_angle_deg(std::string_view text, Range<double> range_deg) {
  const auto angle = parse_leading_number(text);
  const bool has_unit = angle && (angle->rest == "deg" || (angle->number == 0.0 && angle->rest.empty()));
  if (!has_unit) {
    return Error{ErrorCode::malformed, "'" + excerpt(text) + "' is not an angle with a unit, like 10deg"};
  }
  if (!range_deg.contains(angle->number)) {
    return Error{ErrorCode::out_of_range, "'" + excerpt(text) + "' must be from " +
                                              number_text(range_deg.low) + "deg to " +
                                              number_text(range_deg.high) + "deg"};
  }
  return angle->number;
}

Result<std::vector<double>> parse_lengths(std::string_view text, std::size_t count, Range<double> range_m) {
  const Error malformed{ErrorCode::malformed, "'" + excerpt(text) + "' is not " + std::to_string(count) +
                                                  " lengths with a unit, like " +
                                                  (count == 2 ? "60x40mm" : "60x40x20mm") +
                                                  " (mm, cm, m or in)"};
  std::vector<double> lengths(count);
  double unit = 0.0;
  for (std::size_t k = count; k-- > 0;) {
    const std::size_t cross = text.rfind('x');
    if ((cross == std::string_view::npos) != (k == 0)) return malformed;
    const auto length = parse_leading_number(k == 0 ? text : text.substr(cross + 1));
    if (!length) return malformed;
    if (!length->rest.empty()) {
      const auto named = find_length_unit(length->rest);
      if (!named) return malformed;
      unit = named->metres;
    }
    lengths[k] = length->number * unit;
    if (!(unit > 0.0) || !range_m.contains(lengths[k])) return malformed;
    text = text.substr(0, cross);
  }
  return lengths;
}

namespace {

// Parses three values with commas between them. `parse` returns a value, or nothing for other text.
template <class Parse>
std::optional<Vector3> parse_three(std::string_view text, const Parse& parse) {
  const auto parts = split_exactly<3>(text);
  if (!parts) return std::nullopt;
  Vector3 values;
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = parse((*parts)[static_cast<std::size_t>(axis)]);
    if (!value) return std::nullopt;
    values[axis] = *value;
  }
  return values;
}

bool is_in_range(const Vector3& values, const Range<double>& range) {
  return range.contains(values.x()) && range.contains(values.y()) && range.contains(values.z());
}

}  // namespace

Result<Vector3> parse_position(std::string_view text) {
  const Error malformed{
      ErrorCode::malformed,
      "'" + excerpt(text, 80) +
          "' is not a position like 10mm,0,-5mm, of at most 100 m with units (mm, cm, m or in)"};
  const auto position_m = parse_three(text, [](std::string_view part) { return parse_length_m(part); });
  if (!position_m || !is_in_range(*position_m, position_range_m)) return malformed;
  return *position_m;
}

Result<Vector3> parse_axis(std::string_view text) {
  for (int axis = 0; axis < 3; ++axis) {
    if (text == std::string(1, static_cast<char>('x' + axis))) return Vector3(Vector3::Unit(axis));
  }
  const Error malformed{ErrorCode::malformed,
                        "'" + excerpt(text, 80) + "' is not x, y, z or a direction like 0,1,-1"};
  const auto direction = parse_three(text, [](std::string_view part) { return parse_plain_number(part); });
  if (!direction) return malformed;
  const double length = direction->stableNorm();
  if (!(length > 1e-100 && length < 1e100)) return malformed;
  return Vector3(*direction / length);
}

Result<Vector3> parse_scale(std::string_view text, Range<double> range) {
  const auto one = parse_plain_number(text);
  if (one && range.contains(*one)) return Vector3(Vector3::Constant(*one));
  const Error malformed{ErrorCode::out_of_range,
                        "'" + excerpt(text, 80) + "' is not a factor like 1.2, or three like 1.2,1,1, from " +
                            number_text(range.low) + " to " + number_text(range.high)};
  const auto factors = parse_three(text, [](std::string_view part) { return parse_plain_number(part); });
  if (!factors || !is_in_range(*factors, range)) return malformed;
  return *factors;
}

Result<Pose> parse_pose(std::string_view text) {
  const Error malformed{
      ErrorCode::malformed,
      "'" + excerpt(text, 80) +
          "' is not a pose like 10mm,0,0,1,0,0,0: a position of at most 100 m with units (mm, cm, m "
          "or in), then a quaternion w,x,y,z"};
  const auto parts = split_exactly<7>(text);
  if (!parts) return malformed;
  Pose pose;
  for (int axis = 0; axis < 3; ++axis) {
    const auto length = parse_length_m((*parts)[axis]);
    if (!length || !position_range_m.contains(*length)) return malformed;
    pose.position_m[axis] = *length;
  }
  std::array<double, 4> rotation{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto number = parse_plain_number((*parts)[3 + k]);
    if (!number) return malformed;
    rotation[k] = *number;
  }
  const Quaternion orientation(rotation[0], rotation[1], rotation[2], rotation[3]);
  const double length = orientation.coeffs().stableNorm();
  if (!(length > 1e-100 && length < 1e100)) return malformed;
  pose.orientation = Quaternion(orientation.coeffs() / length);
  return pose;
}

Result<int> parse_continuity(const std::string& text) {
  constexpr int highest = max_degree - 1;
  if (text.size() == 2 && (text[0] == 'C' || text[0] == 'c') && text[1] >= '0' && text[1] <= '0' + highest) {
    return text[1] - '0';
  }
  return Error{ErrorCode::malformed,
               "'" + excerpt(text) + "' is not a continuity from C0 to C" + std::to_string(highest)};
}

Result<std::vector<int>> parse_number_list(std::string_view text) {
  constexpr Range<int> range{1, 1000};
  const Error malformed{ErrorCode::malformed,
                        "'" + excerpt(text) + "' is not a list like 1,3-5 of numbers from 1 to 1000"};
  std::vector<int> numbers;
  for (std::string_view rest = text;;) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const std::size_t dash = part.find('-');
    const auto first = parse_whole_number(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : parse_whole_number(part.substr(dash + 1));
    if (!first || !last || !range.contains(*first) || !range.contains(*last) || *last < *first) {
      return malformed;
    }
    for (int number = *first; number <= *last; ++number) {
      if (std::find(numbers.begin(), numbers.end(), number) == numbers.end()) numbers.push_back(number);
    }
    if (part.size() == rest.size()) return numbers;
    rest.remove_prefix(part.size() + 1);
  }
}

Result<Side> parse_side(std::string_view text) {
  for (const Side side : all_sides) {
    if (text == side_name(side)) return side;
  }
  return Error{ErrorCode::unknown,
               "edge '" + excerpt(text) + "' is unknown; choose u_start, u_end, v_start or v_end"};
}

Result<LengthUnit> parse_unit(std::string_view text) {
  if (const auto unit = find_length_unit(text)) return *unit;
  return Error{ErrorCode::unknown,
               "'" + excerpt(text) + "' is not a supported unit of length; choose mm, cm, m or in"};
}

Result<std::vector<Vector3>> parse_points(const std::string& text) {
  const Error malformed{
      ErrorCode::malformed,
      "'" + excerpt(text) +
          "' is not a list of points like 0,0,0;10,5,0;20,0,0mm, with the unit of all of them "
          "at its end (mm, cm, m or in)"};
  const std::size_t unit_at = text.find_last_of("0123456789.");
  const auto unit =
      find_length_unit(std::string_view(text).substr(unit_at == std::string::npos ? 0 : unit_at + 1));
  if (!unit) return malformed;
  std::vector<Vector3> points;
  for (const std::string_view part : split_and_trim(std::string_view(text).substr(0, unit_at + 1), ';')) {
    const auto numbers = split_and_trim(part, ',');
    if (numbers.size() != 3) return malformed;
    Vector3 point;
    for (int axis = 0; axis < 3; ++axis) {
      const auto number = parse_table_number<double>(numbers[static_cast<std::size_t>(axis)]);
      if (!number || !(std::abs(*number * unit->metres) <= coordinate_limit_m)) return malformed;
      point[axis] = *number * unit->metres;
    }
    points.push_back(point);
  }
  return points;
}

Result<PointTable> read_point_table(const std::filesystem::path& file,
                                    const std::vector<std::string>& columns, bool with_section) {
  const auto text = read_file(file, table_bytes_limit);
  if (!text) return text.error();
  return point_table(text.value(), file.string(), columns, with_section);
}

Result<PointTable> point_table(const std::string& text, const std::string& source,
                               const std::vector<std::string>& columns, bool with_section) {
  TableReader reader(source, columns, with_section);
  std::string_view rest = without_byte_order_mark(text);
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    if (Status added = reader.add_line(rest.substr(0, end)); !added) return added.error();
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  return std::move(reader).finish();
}

}  // namespace spoonbill
