#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/exchange/points/number_lines.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {
namespace {

constexpr std::size_t column_limit = 32;

struct Row {
  std::array<double, column_limit> numbers{};
  std::size_t count = 0;
  bool all_numbers = true;
};

Row row_of(std::string_view line) {
  Row row;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    const auto number = number_of(word);
    row.all_numbers = row.all_numbers && number.has_value();
    if (row.count < column_limit) row.numbers[row.count++] = number.value_or(0.0);
  }
  return row;
}

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with("//");
}

Error no_point(std::size_t line, std::string_view text) {
  return Error{"line " + std::to_string(line) + " is no point: '" + std::string(text.substr(0, 60)) +
               "'; a line has x, y and z"};
}

bool is_unit(const Vector3& vector) {
  return std::abs(vector.norm() - 1.0) < 0.01;
}

}  // namespace

Result<PointCloud> text_points(std::string_view bytes) {
  PointGatherer gatherer;
  std::size_t columns = 0, line_number = 0;
  bool units = true;  // columns 4 to 6 so far have the length 1
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    ++line_number;
    const Row row = is_comment(line) ? Row{} : row_of(line);
    if (row.count == 0) continue;
    const bool is_first = columns == 0;
    if (is_first && (!row.all_numbers || row.count == 1)) {
      if (line_number == 1) continue;  // the names of the columns, or the count of points
      return no_point(line_number, line);
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
  while (!bytes.empty()) {
    const std::string_view line = take_line(bytes);
    ++line_number;
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword != "v" && keyword != "vn") continue;
    const Row row = row_of(rest);
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
