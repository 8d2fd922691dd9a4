#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "engine/base/text.h"
#include "engine/exchange/points/number_lines.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {
namespace {

constexpr std::size_t column_limit = 32;
constexpr std::size_t excerpt_length = 60;

struct Row {
  std::array<double, column_limit> numbers{};
  std::size_t count = 0;
  bool all_numbers = true;
  bool is_ambiguous = false;  // its commas may part numbers or be within them

  void add(std::optional<double> number) {
    all_numbers = all_numbers && number.has_value();
    if (count < column_limit) numbers[count++] = number.value_or(0.0);
  }
};

Row row_of(std::string_view line, std::string_view marks) {
  Row row;
  for (std::string_view word = take_word(line, marks); !word.empty(); word = take_word(line, marks)) {
    row.add(number_of(word));
  }
  return row;
}

// "12,5" as many languages write it.
std::optional<double> decimal_comma_number(std::string_view word) {
  std::string text(word);
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return number_of(word);
  const auto is_digit = [&](std::size_t at) {
    return at < text.size() && text[at] >= '0' && text[at] <= '9';
  };
  if (comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1)) return {};
  text[comma] = '.';
  return number_of(text);
}

Row decimal_comma_row(std::string_view line) {
  Row row;
  for (std::string_view word = take_word(line, ";"); !word.empty(); word = take_word(line, ";")) {
    row.add(decimal_comma_number(word));
  }
  return row;
}

// Without what parts nothing: blanks and a semicolon at its ends.
std::string_view inner_part(std::string_view line) {
  constexpr std::string_view nothing = " \t\r\v\f;";
  const std::size_t begin = line.find_first_not_of(nothing);
  return begin == std::string_view::npos ? std::string_view()
                                         : line.substr(begin, line.find_last_not_of(nothing) - begin + 1);
}

// Whether a comma stands between two characters that are neither blank nor semicolon.
bool has_inner_comma(std::string_view line) {
  constexpr std::string_view outer = " \t\r\v\f;,";
  for (std::size_t at = line.find(',', 1); at < line.size(); at = line.find(',', at + 1)) {
    const bool ends_line = at + 1 == line.size();
    if (!ends_line && outer.find(line[at - 1]) == std::string_view::npos &&
        outer.find(line[at + 1]) == std::string_view::npos) {
      return true;
    }
  }
  return false;
}

// Between blanks, commas or semicolons. A comma within a word where others part the words is a decimal one
// between semicolons; between blanks it may as well part thousands or columns.
Row row_of_text(std::string_view line) {
  Row row = row_of(line, ",;");
  line = inner_part(line);
  const bool has_others = line.find_first_of(" \t\v\f;") != std::string_view::npos;
  if (!row.all_numbers || !has_others || !has_inner_comma(line)) return row;
  if (line.find(';') != std::string_view::npos && line.find('.') == std::string_view::npos) {
    const Row decimal = decimal_comma_row(line);
    if (decimal.all_numbers) return decimal;
  }
  row.is_ambiguous = true;
  return row;
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//");
}

Error no_point(std::size_t line, std::string_view text) {
  return Error{"line " + std::to_string(line) + " is no point: '" + excerpt(text, excerpt_length) +
               "'; a line has x, y and z"};
}

Error ambiguous(std::size_t line, std::string_view text) {
  return Error{"line " + std::to_string(line) +
               " has commas that may be within its numbers or between them: '" +
               excerpt(text, excerpt_length) + "'; write decimal points, or semicolons between the numbers"};
}

bool is_unit(const Vector3& vector) {
  return std::abs(vector.norm() - 1.0) < 0.01;
}

}  // namespace

Result<PointCloud> text_points(std::string_view bytes) {
  PointGatherer gatherer;
  std::size_t columns = 0, line_number = 0;
  bool has_heading = false;
  bytes = without_byte_order_mark(bytes);
  bool units = true;  // columns 4 to 6 so far have the length 1
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    ++line_number;
    const Row row = is_comment(line) ? Row{} : row_of_text(line);
    if (row.count == 0) continue;
    if (row.is_ambiguous) return ambiguous(line_number, line);
    const bool is_first = columns == 0;
    if (is_first && (!row.all_numbers || row.count == 1)) {
      if (has_heading) return no_point(line_number, line);
      has_heading = true;  // the names of the columns, or the count of points
      continue;
    }
    if (!row.all_numbers || row.count < 3) return no_point(line_number, line);
    if (is_first) {
      columns = row.count;
      if (Status expected = gatherer.expect(0, columns >= 6); !expected) return expected.error();
    }
    if (row.count != columns) {
      return Error{"line " + std::to_string(line_number) + " has " + std::to_string(row.count) +
                   " numbers, the first point has " + std::to_string(columns) + "; it is cut or damaged"};
    }
    const Vector3 normal(row.numbers[3], row.numbers[4], row.numbers[5]);
    units = units && columns >= 6 && is_unit(normal);
    const Status added = gatherer.add({row.numbers[0], row.numbers[1], row.numbers[2]}, normal);
    if (!added) return added.error();
  }
  auto cloud = std::move(gatherer).done();
  if (cloud && !units) cloud->normals.clear();
  return cloud;
}

Result<PointCloud> obj_points(std::string_view bytes) {
  PointGatherer gatherer;
  std::vector<Vector3> normals;
  std::size_t line_number = 0;
  bytes = without_byte_order_mark(bytes);
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    ++line_number;
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword != "v" && keyword != "vn") continue;
    const Row row = row_of(rest, {});
    if (!row.all_numbers || row.count < 3) return no_point(line_number, line);
    const Vector3 vector(row.numbers[0], row.numbers[1], row.numbers[2]);
    if (keyword == "vn") {
      if (normals.size() < point_limit) normals.push_back(vector);
    } else if (Status added = gatherer.add(vector, Vector3::Zero()); !added) {
      return added.error();
    }
  }
  auto cloud = std::move(gatherer).done();
  if (cloud && cloud->skipped == 0 && normals.size() == cloud->points.size()) {
    cloud->normals = std::move(normals);
  }
  return cloud;
}

bool obj_has_faces(std::string_view bytes) {
  while (!bytes.empty()) {
    std::string_view line = take_line(bytes);
    if (take_word(line) == "f") return true;
  }
  return false;
}

}  // namespace spoonbill
