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
  std::optional<NumberType> list_count = {};  // of a list, the type of its length
};

struct Element {
  std::string_view name;
  std::uint64_t rows = 0;
  std::vector<Property> properties = {};
};

enum class Format { text, little, big };

struct Header {
  std::optional<Format> format;
  std::vector<Element> elements;
  std::string_view body;
};

std::optional<NumberType> type_of(std::string_view name) {
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

Error damaged_line(std::string_view line) {
  return Error{"its header has a line that is no PLY: '" + std::string(line.substr(0, 60)) + "'"};
}

Status read_property(std::string_view rest, std::string_view line, std::vector<Element>& elements) {
  if (elements.empty()) return damaged_line(line);
  Property property;
  std::string_view word = take_word(rest);
  if (word == "list") {
    property.list_count = type_of(take_word(rest));
    if (!property.list_count) return damaged_line(line);
    word = take_word(rest);
  }
  const auto type = type_of(word);
  if (!type) return damaged_line(line);
  property.type = *type;
  property.name = take_word(rest);
  elements.back().properties.push_back(property);
  return {};
}

Status read_line(std::string_view line, Header& header) {
  std::string_view rest = line;
  const std::string_view keyword = take_word(rest);
  if (keyword == "format") {
    const std::string_view name = take_word(rest);
    if (name == "ascii") header.format = Format::text;
    if (name == "binary_little_endian") header.format = Format::little;
    if (name == "binary_big_endian") header.format = Format::big;
    return {};
  }
  if (keyword == "property") return read_property(rest, line, header.elements);
  if (keyword != "element") return {};
  const std::string_view name = take_word(rest);
  const auto rows = count_of(take_word(rest));
  if (!rows) return damaged_line(line);
  header.elements.push_back({name, *rows});
  return {};
}

Result<Header> header_of(std::string_view bytes) {
  Header header;
  std::string_view rest = bytes;
  if (take_line(rest) != "ply") return Error{"does not begin with the word ply; it is no PLY file"};
  while (!rest.empty() && bytes.size() - rest.size() < header_bytes_limit) {
    const std::string_view line = take_line(rest);
    if (line == "end_header") {
      header.body = rest;
      if (!header.format) return Error{"its header names no format that is known"};
      return header;
    }
    if (Status read = read_line(line, header); !read) return read.error();
  }
  return Error{"its header has no end within 64 KiB; it is cut or no PLY file"};
}

// Where x, y, z, nx, ny, nz stand among the properties; -1 for those that are not there.
std::array<int, 6> columns_of(const Element& element) {
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

// Takes the numbers of a file one by one.
class Numbers {
 public:
  Numbers(std::string_view body, Format format)
      : rest_(body),
        is_text_(format == Format::text),
        swapped_((format == Format::big) == (std::endian::native == std::endian::little)) {}

  bool take(NumberType type, double& number) {
    if (is_text_) {
      word_ = take_word(rest_);
      const auto read = number_of(word_);
      number = read.value_or(0.0);
      return read.has_value();
    }
    const std::size_t size = bytes_of(type);
    if (rest_.size() < size) return false;
    number = number_at(rest_.data(), type, swapped_);
    rest_.remove_prefix(size);
    return true;
  }

  bool take(const Property& property, double& number) {
    if (!property.list_count) return take(property.type, number);
    double length = 0.0;
    if (!take(*property.list_count, length) || !(length >= 0.0 && length <= 1e9)) return false;
    for (auto left = static_cast<std::uint64_t>(length); left > 0; --left) {
      if (!take(property.type, number)) return false;
    }
    return true;
  }

  std::size_t left() const { return rest_.size(); }
  // The word of a text that was taken last.
  std::string_view word() const { return word_; }

 private:
  std::string_view rest_, word_;
  bool is_text_, swapped_;
};

Error ends_early(const Element& element, std::uint64_t row, std::string_view word = {}) {
  const std::string place =
      excerpt(element.name) + " " + std::to_string(row + 1) + " of " + std::to_string(element.rows);
  if (word.find(',') != std::string_view::npos) {
    return Error{place + " has '" + excerpt(word) + "', a number with a comma; write decimal points"};
  }
  return Error{"it ends or is no number within " + place + "; it is cut or damaged"};
}

Status skip_element(Numbers& numbers, const Element& element) {
  double ignored = 0.0;
  // Rows without properties take no bytes, however many are promised.
  for (std::uint64_t row = 0; row < element.rows && !element.properties.empty(); ++row) {
    for (const Property& property : element.properties) {
      if (!numbers.take(property, ignored)) return ends_early(element, row, numbers.word());
    }
  }
  return {};
}

Result<PointCloud> read_vertices(Numbers& numbers, const Element& element) {
  const std::array<int, 6> columns = columns_of(element);
  if (std::min({columns[0], columns[1], columns[2]}) < 0) return Error{"its vertices have no x, y and z"};
  const bool with_normals = std::min({columns[3], columns[4], columns[5]}) >= 0;
  PointGatherer gatherer;
  // A number takes a byte at least: a header cannot ask for more memory than its file has.
  if (element.rows <= point_limit && element.rows * element.properties.size() > numbers.left()) {
    return ends_early(element, numbers.left() / element.properties.size());
  }
  if (Status expected = gatherer.expect(element.rows, with_normals); !expected) return expected.error();
  std::vector<double> row(element.properties.size());
  for (std::uint64_t r = 0; r < element.rows; ++r) {
    for (std::size_t p = 0; p < row.size(); ++p) {
      if (!numbers.take(element.properties[p], row[p])) return ends_early(element, r, numbers.word());
    }
    const Vector3 normal =
        with_normals ? Vector3(row[columns[3]], row[columns[4]], row[columns[5]]) : Vector3::Zero();
    if (Status added = gatherer.add({row[columns[0]], row[columns[1]], row[columns[2]]}, normal); !added) {
      return added.error();
    }
  }
  return std::move(gatherer).done();
}

}  // namespace

Result<PointCloud> ply_points(std::string_view bytes) {
  const auto header = header_of(bytes);
  if (!header) return header.error();
  Numbers numbers(header->body, *header->format);
  for (const Element& element : header->elements) {
    if (element.name == "vertex") return read_vertices(numbers, element);
    if (Status skipped = skip_element(numbers, element); !skipped) return skipped.error();
  }
  return Error{"its header names no vertices"};
}

std::uint64_t ply_face_count(std::string_view bytes) {
  const auto header = header_of(bytes);
  if (!header) return 0;
  for (const Element& element : header->elements) {
    if (element.name == "face") return element.rows;
  }
  return 0;
}

}  // namespace spoonbill
