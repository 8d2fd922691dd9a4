#include "engine/exchange/ply_check.h"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/text.h"

namespace spoonbill {
namespace {

// Of a list the numbers in it, whose count comes before them.
struct Property {
  bool is_list = false;
  std::size_t count_bytes = 0, bytes = 0;
};

struct Element {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Property> properties;
};

struct Header {
  bool is_text = false, is_big_endian = false;
  std::vector<Element> elements;
};

// None of another name.
std::size_t bytes_of(const std::string& type) {
  static const std::map<std::string, std::size_t> known = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = known.find(type);
  return found == known.end() ? 0 : found->second;
}

// Up to its last line, past which the stream is left.
Result<Header> read_header(std::istream& stream) {
  Header header;
  std::size_t bytes = 0;
  for (std::string line; std::getline(stream, line) && bytes <= ply_header_bytes_limit;) {
    bytes += line.size() + 1;
    std::istringstream words(line);
    std::string keyword, name;
    words >> keyword >> name;
    if (keyword == "end_header") return header;
    if (keyword == "format") {
      header.is_text = name == "ascii";
      header.is_big_endian = name == "binary_big_endian";
    }
    if (keyword == "element") {
      header.elements.push_back({name, 0, {}});
      words >> header.elements.back().rows;
    }
    if (keyword == "property" && !header.elements.empty()) {
      Property property{name == "list", 0, bytes_of(name)};
      std::string count_type, type;
      if (property.is_list && words >> count_type >> type) {
        property.count_bytes = bytes_of(count_type);
        property.bytes = bytes_of(type);
      }
      header.elements.back().properties.push_back(property);
    }
  }
  return Error{"its header has no end within 64 KiB; it is cut or no PLY file"};
}

bool skip(std::istream& stream, std::uint64_t numbers) {
  std::string word;
  while (numbers > 0 && stream >> word) --numbers;
  return numbers == 0;
}

// A list is how many numbers it has, then these.
bool skip_list(std::istream& stream) {
  std::string word;
  if (!(stream >> word)) return false;
  const double count = std::strtod(word.c_str(), nullptr);
  return count >= 0.0 && count < 1e9 && skip(stream, static_cast<std::uint64_t>(count));
}

// More than any file holds, and less than overflows.
constexpr std::uint64_t most_rows = std::uint64_t{1} << 32U;

bool skip_bytes(std::istream& stream, std::uint64_t bytes) {
  stream.ignore(static_cast<std::streamsize>(bytes));
  return static_cast<std::uint64_t>(stream.gcount()) == bytes;
}

bool skip_binary(std::istream& stream, const Property& property, bool is_big_endian) {
  if (!property.is_list) return skip_bytes(stream, property.bytes);
  std::uint64_t count = 0;
  for (std::size_t k = 0; k < property.count_bytes; ++k) {
    const int letter = stream.get();
    if (letter < 0) return false;
    const auto byte = static_cast<std::uint64_t>(letter);
    count = is_big_endian ? count << 8U | byte : count | byte << (8U * k);
  }
  return count < most_rows && skip_bytes(stream, count * property.bytes);
}

bool skip_text(std::istream& stream, const Property& property) {
  return property.is_list ? skip_list(stream) : skip(stream, 1);
}

Status check_types(const Element& element) {
  for (const Property& property : element.properties) {
    if (property.bytes > 0 && (property.count_bytes > 0 || !property.is_list)) continue;
    return Error{"its " + excerpt(element.name) + " has a property of a type that PLY does not have"};
  }
  return {};
}

Error cut_within(const Element& element, std::uint64_t row) {
  return Error{"it ends within " + excerpt(element.name) + " " + std::to_string(row + 1) + " of " +
               std::to_string(element.rows) + "; it is cut or damaged"};
}

// Without a list all rows are alike: zero bytes a row otherwise.
std::size_t bytes_of_a_row(const Header& header, const Element& element) {
  std::size_t bytes = 0;
  for (const Property& property : element.properties) {
    if (header.is_text || property.is_list) return 0;
    bytes += property.bytes;
  }
  return bytes;
}

Status check_rows(std::istream& stream, const Header& header, const Element& element) {
  // Rows of nothing take no bytes, however many are promised.
  if (element.properties.empty()) return {};
  if (Status types = check_types(element); !types && !header.is_text) return types;
  if (const std::size_t bytes = bytes_of_a_row(header, element); bytes > 0) {
    if (element.rows > most_rows) return cut_within(element, most_rows);
    const bool whole = skip_bytes(stream, element.rows * bytes);
    return whole ? Status() : cut_within(element, static_cast<std::uint64_t>(stream.gcount()) / bytes);
  }
  for (std::uint64_t row = 0; row < element.rows; ++row) {
    for (const Property& property : element.properties) {
      if (header.is_text ? skip_text(stream, property)
                         : skip_binary(stream, property, header.is_big_endian)) {
        continue;
      }
      return cut_within(element, row);
    }
  }
  return {};
}

}  // namespace

Status check_ply(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const Result<Header> header = read_header(stream);
  if (!header.ok()) return header.error();
  for (const Element& element : header->elements) {
    if (Status status = check_rows(stream, header.value(), element); !status.ok()) return status;
  }
  return {};
}

}  // namespace spoonbill
