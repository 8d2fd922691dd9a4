// Header of a PLY file: its elements, their rows and the types of their properties (Turk 1994).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/scans/number_lines.h"

namespace spoonbill {

struct PlyProperty {
  std::string_view name;
  NumberType type = NumberType::float32;
  std::optional<NumberType> list_count = {};  // type of the number of items; only for lists
};

struct PlyElement {
  std::string_view name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties = {};

  // Returns the index of the property with this name, which must be a list if `is_list` is true, otherwise a
  // scalar; -1 if the element has no such property.
  int find(std::string_view property, bool is_list) const;
  bool has_lists() const;
};

enum class PlyFormat { text, little_endian, big_endian };

// Header of a PLY file, as views of the file's bytes. The bytes must outlive it.
struct PlyHeader {
  PlyFormat format = PlyFormat::text;
  std::vector<PlyElement> elements;
  std::string_view body;
};

// Reads a header whose lines end with a line feed, a carriage return or both. Refused: a header that does not
// end within 64 KiB, an unknown format or type, a row count that is not a number, two elements of vertices.
Result<PlyHeader> read_ply_header(std::string_view bytes);

}  // namespace spoonbill
