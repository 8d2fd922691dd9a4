// Collection of points, the choice of a reader by the file's name, and the readers of text and OBJ files.
#include "engine/exchange/scans/point_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/scans/number_lines.h"

namespace spoonbill {
namespace {

Error too_many(std::uint64_t count) {
  return Error{ErrorCode::too_many, "has " + std::to_string(count) + " points, more than the " +
                                        std::to_string(point_limit) + " that can be read; thin it out"};
}

constexpr std::size_t column_limit = 32;
constexpr std::size_t excerpt_length = 60;

struct Row {
  std::array<double, column_limit> numbers{};
  std::size_t count = 0;
  bool all_numbers = true;
  bool is_ambiguous = false;  // commas may separate numbers or mark decimals

  void add(std::optional<double> number) {
    all_numbers = all_numbers && number.has_value();
    if (count < column_limit) numbers[count++] = number.value_or(0.0);
  }
};

Row parse_row(std::string_view line, std::string_view separators) {
  Row row;
  for (std::string_view word = extract_word(line, separators); !word.empty();
       word = extract_word(line, separators)) {
    row.add(parse_number(word));
  }
  return row;
}

// Parses a number with a decimal comma, such as "12,5", or a decimal point.
std::optional<double> parse_decimal_comma_number(std::string_view word) {
  std::string text(word);
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return parse_number(word);
  const auto is_digit = [&](std::size_t k) { return k < text.size() && text[k] >= '0' && text[k] <= '9'; };
  if (comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1)) return {};
  text[comma] = '.';
  return parse_number(text);
}

Row parse_decimal_comma_row(std::string_view line) {
  Row row;
  for (std::string_view word = extract_word(line, ";"); !word.empty(); word = extract_word(line, ";")) {
    row.add(parse_decimal_comma_number(word));
  }
  return row;
}

// Returns the line without blanks and semicolons at its ends.
std::string_view trim_separators(std::string_view line) {
  constexpr std::string_view ignored = " \t\r\v\f;";
  const std::size_t begin = line.find_first_not_of(ignored);
  return begin == std::string_view::npos ? std::string_view()
                                         : line.substr(begin, line.find_last_not_of(ignored) - begin + 1);
}

// Returns true if a comma has characters on both sides that are neither blanks nor separators.
bool has_inner_comma(std::string_view line) {
  constexpr std::string_view separators = " \t\r\v\f;,";
  for (std::size_t at = line.find(',', 1); at < line.size(); at = line.find(',', at + 1)) {
    const bool ends_line = at + 1 == line.size();
    if (!ends_line && separators.find(line[at - 1]) == std::string_view::npos &&
        separators.find(line[at + 1]) == std::string_view::npos) {
      return true;
    }
  }
  return false;
}

// Parses numbers separated by blanks, commas or semicolons. If semicolons separate the words, a comma within
// a word is a decimal comma. If blanks separate the words, a comma within a word may also separate thousands
// or columns, and the row is ambiguous.
Row parse_text_row(std::string_view line) {
  Row row = parse_row(line, ",;");
  line = trim_separators(line);
  const bool has_others = line.find_first_of(" \t\v\f;") != std::string_view::npos;
  if (!row.all_numbers || !has_others || !has_inner_comma(line)) return row;
  if (line.find(';') != std::string_view::npos && line.find('.') == std::string_view::npos) {
    const Row decimal = parse_decimal_comma_row(line);
    if (decimal.all_numbers) return decimal;
  }
  row.is_ambiguous = true;
  return row;
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//");
}

Error no_point_error(std::size_t line, std::string_view text) {
  return Error{ErrorCode::malformed, "line " + std::to_string(line) + " is not a point: '" +
                                         excerpt(text, excerpt_length) + "'; a line has x, y and z"};
}

Error ambiguity_error(std::size_t line, std::string_view text) {
  return Error{ErrorCode::malformed, "line " + std::to_string(line) +
                                         " has commas that may be within its numbers or between them: '" +
                                         excerpt(text, excerpt_length) +
                                         "'; write decimal points, or semicolons between the numbers"};
}

Error count_error(double promised, std::size_t points) {
  return Error{ErrorCode::inconsistent, "states " + number_text(promised) + " points but holds " +
                                            std::to_string(points) + "; it is cut or damaged"};
}

bool is_unit(const Vector3& vector) {
  return std::abs(vector.norm() - 1.0) < 0.01;
}

}  // namespace

Status PointCollector::begin(std::uint64_t count, bool with_normals) {
  if (count > point_limit) return too_many(count);
  with_normals_ = with_normals;
  cloud_.points.reserve(count);
  if (with_normals) cloud_.normals.reserve(count);
  return {};
}

Status PointCollector::add(const Vector3& point, const Vector3& normal) {
  ++seen_;
  if (point.hasNaN()) {
    ++cloud_.skipped;
    return {};
  }
  if (!point.allFinite()) {
    return Error{ErrorCode::out_of_range,
                 "point " + std::to_string(seen_) + " is at infinity; remove it or export the scan again"};
  }
  if (cloud_.points.size() == point_limit) return too_many(seen_);
  cloud_.points.push_back(point);
  if (with_normals_) cloud_.normals.push_back(normal.allFinite() ? normal : Vector3::Zero());
  return {};
}

Result<PointCloud> PointCollector::finish() && {
  if (!cloud_.points.empty()) return std::move(cloud_);
  if (cloud_.skipped > 0) {
    return Error{ErrorCode::too_few,
                 "all of its " + std::to_string(cloud_.skipped) +
                     " points have a coordinate that is not a number; export the scan again"};
  }
  return Error{ErrorCode::too_few, "has no points"};
}

Result<PointCloud> parse_text_points(std::string_view bytes) {
  PointCollector collector;
  std::size_t columns = 0, line_number = 0, points = 0;
  bool has_heading = false;
  std::optional<double> promised;  // number of points that the line before the first point states
  bytes = without_byte_order_mark(bytes);
  // True while the vector in columns 4 to 6 has length 1 for all points so far.
  bool are_unit_normals = true;
  while (!bytes.empty()) {
    const std::string_view line = extract_line(bytes);
    ++line_number;
    const Row row = is_comment(line) ? Row{} : parse_text_row(line);
    if (row.count == 0) continue;
    if (row.is_ambiguous) return ambiguity_error(line_number, line);
    const bool is_first = columns == 0;
    if (is_first && (!row.all_numbers || row.count == 1)) {
      if (has_heading) return no_point_error(line_number, line);
      has_heading = true;  // the line names the columns or states the number of points
      if (row.all_numbers) promised = row.numbers[0];
      continue;
    }
    if (!row.all_numbers || row.count < 3) return no_point_error(line_number, line);
    if (is_first) {
      columns = row.count;
      if (Status begun = collector.begin(0, columns >= 6); !begun) return begun.error();
    }
    if (row.count != columns) {
      return Error{ErrorCode::inconsistent, "line " + std::to_string(line_number) + " has " +
                                                std::to_string(row.count) +
                                                " numbers, but the first point has " +
                                                std::to_string(columns) + "; it is cut or damaged"};
    }
    const Vector3 normal(row.numbers[3], row.numbers[4], row.numbers[5]);
    are_unit_normals = are_unit_normals && columns >= 6 && is_unit(normal);
    const Status added = collector.add({row.numbers[0], row.numbers[1], row.numbers[2]}, normal);
    if (!added) return added.error();
    ++points;
  }
  if (promised && points > 0 && *promised != static_cast<double>(points)) {
    return count_error(*promised, points);
  }
  auto cloud = std::move(collector).finish();
  if (cloud && !are_unit_normals) cloud->normals.clear();
  return cloud;
}

Result<PointCloud> parse_obj_points(std::string_view bytes) {
  PointCollector collector;
  std::vector<Vector3> normals;
  std::size_t line_number = 0;
  bytes = without_byte_order_mark(bytes);
  while (!bytes.empty()) {
    const std::string_view line = extract_line(bytes);
    ++line_number;
    std::string_view rest = line;
    const std::string_view keyword = extract_word(rest);
    if (keyword != "v" && keyword != "vn") continue;
    const Row row = parse_row(rest, {});
    if (!row.all_numbers || row.count < 3) return no_point_error(line_number, line);
    const Vector3 vector(row.numbers[0], row.numbers[1], row.numbers[2]);
    if (keyword == "vn") {
      if (normals.size() < point_limit) normals.push_back(vector);
    } else if (Status added = collector.add(vector, Vector3::Zero()); !added) {
      return added.error();
    }
  }
  auto cloud = std::move(collector).finish();
  if (cloud && cloud->skipped == 0 && normals.size() == cloud->points.size()) {
    cloud->normals = std::move(normals);
  }
  return cloud;
}

bool obj_has_faces(std::string_view bytes) {
  while (!bytes.empty()) {
    std::string_view line = extract_line(bytes);
    if (extract_word(line) == "f") return true;
  }
  return false;
}

Result<PointCloud> points_of(std::string_view bytes, const std::filesystem::path& file) {
  const FileFormat format = format_from_name(file);
  SPOONBILL_ASSERT(format != FileFormat::ply);
  auto cloud = format == FileFormat::pcd   ? parse_pcd_points(bytes)
               : format == FileFormat::obj ? parse_obj_points(bytes)
                                           : parse_text_points(bytes);
  if (!cloud) return cloud.error().in(file.string());
  return cloud;
}

}  // namespace spoonbill
