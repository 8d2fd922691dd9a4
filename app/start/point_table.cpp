#include "app/start/point_table.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "app/files/length_unit.h"
#include "engine/base/text.h"
#include "engine/base/file.h"
#include "engine/exchange/points/number_lines.h"

namespace spoonbill {
namespace {

constexpr std::size_t bytes_limit = std::size_t{16} << 20;
constexpr std::size_t most_rows = 100000;
constexpr double farthest_m = 100.0;

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    std::string_view part = text.substr(0, at);
    while (!part.empty() && (part.front() == ' ' || part.front() == '\t')) part.remove_prefix(1);
    while (!part.empty() && (part.back() == ' ' || part.back() == '\t')) {
      part.remove_suffix(1);
    }
    parts.push_back(part);
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

// A plus before a number says nothing.
template <class Number>
std::optional<Number> whole_text_as(std::string_view text) {
  Number number{};
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string header_text(const std::vector<std::string>& columns, bool with_section) {
  std::string text = with_section ? "section," : "";
  for (const std::string& column : columns) text += column + "_mm" + (&column == &columns.back() ? "" : ",");
  return text;
}

// The unit of each column; nothing where they are others.
std::optional<std::vector<double>> units_of(std::vector<std::string_view> names,
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
    const auto unit = unit_named(names[k].substr(start.size()));
    if (!unit) return std::nullopt;
    units.push_back(unit->metres);
  }
  return units;
}

class TableReader {
 public:
  TableReader(const std::string& source, const std::vector<std::string>& columns, bool with_section)
      : source_(source), columns_(columns), with_section_(with_section) {}

  Status take(std::string_view line) {
    ++line_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto parts = parts_of(line, ',');
    if (parts.size() == 1 && parts[0].empty()) return {};
    if (parts[0].starts_with('#')) return {};
    if (units_.empty()) {
      const auto units = units_of(parts, columns_, with_section_);
      if (!units) {
        return refusal("names the columns '" + excerpt(line) + "'; they are to be " +
                       header_text(columns_, with_section_) + ", or in cm, m or in");
      }
      units_ = *units;
      return {};
    }
    return take_row(parts);
  }

  Result<PointTable> finished() && {
    if (table_.rows_m.empty()) return Error{source_ + ": holds no points"};
    return std::move(table_);
  }

 private:
  Error refusal(const std::string& message) const {
    return Error{source_ + ":" + std::to_string(line_) + ": " + message};
  }

  Status take_row(std::vector<std::string_view> parts) {
    const std::size_t wanted = columns_.size() + (with_section_ ? 1 : 0);
    if (parts.size() != wanted) {
      return refusal("has " + std::to_string(parts.size()) + " values, must be " + std::to_string(wanted));
    }
    if (table_.rows_m.size() >= most_rows) {
      return refusal("is beyond the " + std::to_string(most_rows) + " points that are read; leave some out");
    }
    if (with_section_) {
      const auto section = whole_text_as<int>(parts[0]);
      if (!section) return refusal("section '" + excerpt(parts[0]) + "' is not a whole number");
      table_.sections.push_back(*section);
      parts.erase(parts.begin());
    }
    std::vector<double> row;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto number = whole_text_as<double>(parts[k]);
      if (!number || !(std::abs(*number * units_[k]) <= farthest_m)) {
        return refusal(columns_[k] + " is '" + excerpt(parts[k]) + "', must be a number of at most 100 m");
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
  std::vector<double> units_;
  PointTable table_;
};

}  // namespace

Result<PointTable> point_table(const std::string& text, const std::string& source,
                               const std::vector<std::string>& columns, bool with_section) {
  TableReader reader(source, columns, with_section);
  std::string_view left = without_byte_order_mark(text);
  while (!left.empty()) {
    const std::size_t end = left.find('\n');
    if (Status taken = reader.take(left.substr(0, end)); !taken) return taken.error();
    left = end == std::string_view::npos ? std::string_view() : left.substr(end + 1);
  }
  return std::move(reader).finished();
}

Result<PointTable> read_point_table(const std::filesystem::path& file,
                                    const std::vector<std::string>& columns, bool with_section) {
  const auto text = read_file(file, bytes_limit);
  if (!text) return text.error();
  return point_table(text.value(), file.string(), columns, with_section);
}

Result<std::vector<Vector3>> parse_points(const std::string& text) {
  const Error refusal{"'" + excerpt(text) +
                      "' is not a line of points like 0,0,0;10,5,0;20,0,0mm, with the unit of all of them at "
                      "its end (mm, cm, m or in)"};
  const std::size_t unit_at = text.find_last_of("0123456789.");
  const auto unit = unit_named(std::string_view(text).substr(unit_at == std::string::npos ? 0 : unit_at + 1));
  if (!unit) return refusal;
  std::vector<Vector3> points;
  for (const std::string_view part : parts_of(std::string_view(text).substr(0, unit_at + 1), ';')) {
    const auto numbers = parts_of(part, ',');
    if (numbers.size() != 3) return refusal;
    Vector3 point;
    for (int axis = 0; axis < 3; ++axis) {
      const auto number = whole_text_as<double>(numbers[static_cast<std::size_t>(axis)]);
      if (!number || !(std::abs(*number * unit->metres) <= farthest_m)) return refusal;
      point[axis] = *number * unit->metres;
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace spoonbill
