#include "engine/exchange/scans/ply_header.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "engine/base/text.h"

namespace spoonbill {
namespace {

constexpr std::size_t header_bytes_limit = 65536;
constexpr std::size_t shown_bytes = 60;

std::optional<NumberType> find_ply_type(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, NumberType>, 18> names{
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
       {"int64", NumberType::int64},
       {"uint64", NumberType::uint64},
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
               "its header has a line that is not PLY: '" + excerpt(line, shown_bytes) + "'"};
}

Error type_error(const PlyElement& element) {
  return Error{ErrorCode::unknown,
               "its " + excerpt(element.name) + " has a property of a type that PLY does not have"};
}

Status read_property(std::string_view rest, std::string_view line, std::vector<PlyElement>& elements) {
  if (elements.empty()) return line_error(line);
  PlyProperty property;
  std::string_view word = extract_word(rest);
  if (word == "list") {
    property.list_count = find_ply_type(extract_word(rest));
    if (!property.list_count) return type_error(elements.back());
    word = extract_word(rest);
  }
  const auto type = find_ply_type(word);
  if (!type) return type_error(elements.back());
  property.type = *type;
  property.name = extract_word(rest);
  elements.back().properties.push_back(property);
  return {};
}

Status read_element(std::string_view rest, std::string_view line, std::vector<PlyElement>& elements) {
  const std::string_view name = extract_word(rest);
  const auto rows = parse_count(extract_word(rest));
  if (!rows) return line_error(line);
  const auto is_same = [&](const PlyElement& element) { return element.name == name; };
  if (name == "vertex" && std::any_of(elements.begin(), elements.end(), is_same)) {
    return Error{ErrorCode::duplicate, "its header declares vertices twice"};
  }
  elements.push_back({name, *rows});
  return {};
}

std::optional<PlyFormat> find_format(std::string_view name) {
  if (name == "ascii") return PlyFormat::text;
  if (name == "binary_little_endian") return PlyFormat::little_endian;
  if (name == "binary_big_endian") return PlyFormat::big_endian;
  return {};
}

// Removes the next line and returns it. If the first line of the header ends with a lone carriage return, all
// lines of the header do. A line feed right after the header is then the first byte of the data.
std::string_view extract_header_line(std::string_view& rest, bool ends_with_return) {
  if (!ends_with_return) return extract_line(rest);
  const std::size_t end = std::min(rest.find('\r'), rest.size());
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return line;
}

}  // namespace

int PlyElement::find(std::string_view property, bool is_list) const {
  for (std::size_t p = 0; p < properties.size(); ++p) {
    if (properties[p].name == property && properties[p].list_count.has_value() == is_list) {
      return static_cast<int>(p);
    }
  }
  return -1;
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& property) { return property.list_count.has_value(); });
}

Result<PlyHeader> read_ply_header(std::string_view bytes) {
  std::string_view rest = without_byte_order_mark(bytes);
  const std::size_t end = rest.substr(0, shown_bytes).find_first_of("\r\n");
  const bool ends_with_return =
      end != std::string_view::npos && rest[end] == '\r' && rest.substr(end + 1, 1) != "\n";
  std::string_view first = extract_header_line(rest, ends_with_return);
  if (extract_word(first) != "ply") {
    return Error{ErrorCode::malformed, "does not begin with the word ply; it is not a PLY file"};
  }
  PlyHeader header;
  std::optional<PlyFormat> format;
  while (!rest.empty() && bytes.size() - rest.size() < header_bytes_limit) {
    const std::string_view line = extract_header_line(rest, ends_with_return);
    std::string_view words = line;
    const std::string_view keyword = extract_word(words);
    Status read;
    if (keyword == "format") {
      format = find_format(extract_word(words));
    } else if (keyword == "element") {
      read = read_element(words, line, header.elements);
    } else if (keyword == "property") {
      read = read_property(words, line, header.elements);
    } else if (keyword == "end_header") {
      if (!format) return Error{ErrorCode::unsupported, "its header states no known format"};
      header.format = *format;
      header.body = rest;
      return header;
    }
    if (!read) return read.error();
  }
  return Error{ErrorCode::malformed, "its header has no end within 64 KiB; it is cut or not a PLY file"};
}

}  // namespace spoonbill
