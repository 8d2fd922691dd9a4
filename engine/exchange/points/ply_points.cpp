#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/points/number_lines.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {
namespace {

constexpr std::size_t header_bytes_limit = 65536;

struct Property {
  std::string_view name;
  NumberType type = NumberType::float32;
  std::optional<NumberType> list_count = {};  // type of a list's length; empty if the property is not a list
};

struct Element {
  std::string_view name;
  std::uint64_t rows = 0;
  std::vector<Property> properties = {};
};

enum class Format { text, little, big };

struct PlyHeader {
  std::optional<Format> format;
  std::vector<Element> elements;
  std::string_view body;
};

std::optional<NumberType> find_type(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, NumberType>, 16> names{
      {{"char", NumberType::int8},
       {"int8", NumberType::int8},
       {"uchar", NumberType::uint8},
       {"uint8", NumberType::uint8},
       {"short", NumberType::int16},
       {"int16", NumberType::int16},
       {"ushort", NumberType::uint16},
       {"uint16", NumberType::uint16},
       {"int", NumberType::int32},
       {"int32", NumberType::int32},
       {"uint", NumberType::uint32},
       {"uint32", NumberType::uint32},
       {"float", NumberType::float32},
       {"float32", NumberType::float32},
       {"double", NumberType::float64},
       {"float64", NumberType::float64}}};
  for (const auto& [known, type] : names) {
    if (known == name) return type;
  }
  return {};
}

Error line_error(std::string_view line) {
  return Error{ErrorCode::malformed,
               "its header has a line that is not PLY: '" + std::string(line.substr(0, 60)) + "'"};
}

Status read_property(std::string_view rest, std::string_view line, std::vector<Element>& elements) {
  if (elements.empty()) return line_error(line);
  Property property;
  std::string_view word = extract_word(rest);
  if (word == "list") {
    property.list_count = find_type(extract_word(rest));
    if (!property.list_count) return line_error(line);
    word = extract_word(rest);
  }
  const auto type = find_type(word);
  if (!type) return line_error(line);
  property.type = *type;
  property.name = extract_word(rest);
  elements.back().properties.push_back(property);
  return {};
}

Status read_line(std::string_view line, PlyHeader& header) {
  std::string_view rest = line;
  const std::string_view keyword = extract_word(rest);
  if (keyword == "format") {
    const std::string_view name = extract_word(rest);
    if (name == "ascii") header.format = Format::text;
    if (name == "binary_little_endian") header.format = Format::little;
    if (name == "binary_big_endian") header.format = Format::big;
    return {};
  }
  if (keyword == "property") return read_property(rest, line, header.elements);
  if (keyword != "element") return {};
  const std::string_view name = extract_word(rest);
  const auto rows = parse_count(extract_word(rest));
  if (!rows) return line_error(line);
  header.elements.push_back({name, *rows});
  return {};
}

Result<PlyHeader> read_ply_header(std::string_view bytes) {
  PlyHeader header;
  std::string_view rest = bytes;
  if (extract_line(rest) != "ply") {
    return Error{ErrorCode::malformed, "does not begin with the word ply; it is not a PLY file"};
  }
  while (!rest.empty() && bytes.size() - rest.size() < header_bytes_limit) {
    const std::string_view line = extract_line(rest);
    if (line == "end_header") {
      header.body = rest;
      if (!header.format) return Error{ErrorCode::unsupported, "its header does not name a known format"};
      return header;
    }
    if (Status read = read_line(line, header); !read) return read.error();
  }
  return Error{ErrorCode::malformed, "its header has no end within 64 KiB; it is cut or not a PLY file"};
}

// Returns the indices of the properties x, y, z, nx, ny and nz; -1 for missing ones.
std::array<int, 6> find_coordinate_columns(const Element& element) {
  static constexpr std::array<std::string_view, 6> names{"x", "y", "z", "nx", "ny", "nz"};
  std::array<int, 6> columns;
  columns.fill(-1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (element.properties[p].name == names[k] && !element.properties[p].list_count) {
        columns[k] = static_cast<int>(p);
      }
    }
  }
  return columns;
}

// Reader of the numbers of a body, one by one. read() returns false at the end or if the next word is not a
// number.
class NumberReader {
 public:
  NumberReader(std::string_view body, Format format)
      : rest_(body),
        is_text_(format == Format::text),
        swapped_((format == Format::big) == (std::endian::native == std::endian::little)) {}

  bool read(NumberType type, double& number) {
    if (is_text_) {
      word_ = extract_word(rest_);
      const auto parsed = parse_number(word_);
      number = parsed.value_or(0.0);
      return parsed.has_value();
    }
    const std::size_t size = byte_count(type);
    if (rest_.size() < size) return false;
    number = number_at(rest_.data(), type, swapped_);
    rest_.remove_prefix(size);
    return true;
  }

  bool read(const Property& property, double& number) {
    if (!property.list_count) return read(property.type, number);
    double length = 0.0;
    if (!read(*property.list_count, length) || !(length >= 0.0 && length <= 1e9)) return false;
    for (auto remaining = static_cast<std::uint64_t>(length); remaining > 0; --remaining) {
      if (!read(property.type, number)) return false;
    }
    return true;
  }

  std::size_t remaining_bytes() const { return rest_.size(); }
  // Returns the word that was last read from text.
  std::string_view word() const { return word_; }

 private:
  std::string_view rest_, word_;
  bool is_text_, swapped_;
};

Error truncated_error(const Element& element, std::uint64_t row, std::string_view word = {}) {
  const std::string row_name =
      excerpt(element.name) + " " + std::to_string(row + 1) + " of " + std::to_string(element.rows);
  if (word.find(',') != std::string_view::npos) {
    return Error{ErrorCode::malformed,
                 row_name + " has '" + excerpt(word) + "', a number with a comma; write decimal points"};
  }
  return Error{ErrorCode::malformed,
               "it ends or has no number within " + row_name + "; it is cut or damaged"};
}

Status skip_element(NumberReader& numbers, const Element& element) {
  double ignored = 0.0;
  // Rows without properties need no bytes, however many rows the header promises.
  for (std::uint64_t row = 0; row < element.rows && !element.properties.empty(); ++row) {
    for (const Property& property : element.properties) {
      if (!numbers.read(property, ignored)) return truncated_error(element, row, numbers.word());
    }
  }
  return {};
}

Result<PointCloud> read_vertices(NumberReader& numbers, const Element& element) {
  const std::array<int, 6> columns = find_coordinate_columns(element);
  if (std::min({columns[0], columns[1], columns[2]}) < 0) {
    return Error{ErrorCode::missing, "its vertices have no x, y and z"};
  }
  const bool with_normals = std::min({columns[3], columns[4], columns[5]}) >= 0;
  PointCollector collector;
  // A number takes at least one byte; this check keeps a header from requesting more memory than the file's
  // size justifies.
  if (element.rows <= point_limit && element.rows * element.properties.size() > numbers.remaining_bytes()) {
    return truncated_error(element, numbers.remaining_bytes() / element.properties.size());
  }
  if (Status begun = collector.begin(element.rows, with_normals); !begun) return begun.error();
  std::vector<double> row(element.properties.size());
  for (std::uint64_t r = 0; r < element.rows; ++r) {
    for (std::size_t p = 0; p < row.size(); ++p) {
      if (!numbers.read(element.properties[p], row[p])) return truncated_error(element, r, numbers.word());
    }
    const Vector3 normal =
        with_normals ? Vector3(row[columns[3]], row[columns[4]], row[columns[5]]) : Vector3::Zero();
    if (Status added = collector.add({row[columns[0]], row[columns[1]], row[columns[2]]}, normal); !added) {
      return added.error();
    }
  }
  return std::move(collector).finish();
}

}  // namespace

Result<PointCloud> parse_ply_points(std::string_view bytes) {
  const auto header = read_ply_header(bytes);
  if (!header) return header.error();
  NumberReader numbers(header->body, *header->format);
  for (const Element& element : header->elements) {
    if (element.name == "vertex") return read_vertices(numbers, element);
    if (Status skipped = skip_element(numbers, element); !skipped) return skipped.error();
  }
  return Error{ErrorCode::missing, "its header names no vertices"};
}

std::uint64_t ply_face_count(std::string_view bytes) {
  const auto header = read_ply_header(bytes);
  if (!header) return 0;
  for (const Element& element : header->elements) {
    if (element.name == "face") return element.rows;
  }
  return 0;
}

}  // namespace spoonbill
