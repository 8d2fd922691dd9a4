#include "engine/exchange/scans/stl_file.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <string>

#include "engine/base/text.h"
#include "engine/exchange/scans/number_lines.h"

namespace spoonbill {
namespace {

constexpr std::size_t count_offset = 80, head_bytes = 84, triangle_bytes = 50;
constexpr std::size_t normal_bytes = 12, coordinate_bytes = 4;

std::size_t count_triangles(std::string_view bytes) {
  return static_cast<std::size_t>(number_at(bytes.data() + count_offset, NumberType::uint32, false));
}

bool is_binary(std::string_view bytes) {
  return bytes.size() >= head_bytes && bytes.size() == head_bytes + triangle_bytes * count_triangles(bytes);
}

// Appends a triangle between the last three vertices.
void add_triangle(FileMesh& mesh) {
  const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

FileMesh read_binary(std::string_view bytes) {
  FileMesh mesh;
  const std::size_t count = count_triangles(bytes);
  mesh.vertices.reserve(3 * count);
  mesh.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char* at = bytes.data() + head_bytes + triangle_bytes * t + normal_bytes;
    for (int corner = 0; corner < 3; ++corner) {
      Vector3& vertex = mesh.vertices.emplace_back();
      for (int axis = 0; axis < 3; ++axis, at += coordinate_bytes) {
        vertex[axis] = number_at(at, NumberType::float32, false);
      }
    }
    add_triangle(mesh);
  }
  return mesh;
}

bool equals_keyword(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), [](char letter, char expected) {
    return std::tolower(static_cast<unsigned char>(letter)) == expected;
  });
}

std::string_view last_line(std::string_view text) {
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  const std::size_t end = text.find_last_of("\r\n");
  if (end != std::string_view::npos) text.remove_prefix(end + 1);
  return text;
}

bool ends_as_text(std::string_view text) {
  std::string_view line = last_line(text);
  return equals_keyword(extract_word(line), "endsolid");
}

// Reader of the words of an STL file in text form.
class TextReader {
 public:
  explicit TextReader(std::string_view text) : all_(text), rest_(text) {}

  Result<FileMesh> read() {
    std::string_view word = extract_word(rest_);
    while (equals_keyword(word, "solid")) {
      extract_line(rest_);  // the name
      for (word = extract_word(rest_); equals_keyword(word, "facet"); word = extract_word(rest_)) {
        if (Status facet = read_facet(); !facet) return facet.error();
      }
      if (!equals_keyword(word, "endsolid")) return misplaced(word, "endsolid");
      extract_line(rest_);  // the name
      word = extract_word(rest_);
    }
    if (!word.empty()) return misplaced(word, "solid");
    return std::move(mesh_);
  }

 private:
  Status read_facet() {
    if (Status normal = skip_words({"normal"}); !normal) return normal;
    for (int axis = 0; axis < 3; ++axis) extract_word(rest_);
    if (Status loop = skip_words({"outer", "loop"}); !loop) return loop;
    for (int corner = 0; corner < 3; ++corner) {
      if (Status vertex = skip_words({"vertex"}); !vertex) return vertex;
      Vector3 position;
      for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = extract_word(rest_);
        const std::optional<double> number = parse_number(word);
        if (!number) return misplaced(word, "a number");
        position[axis] = *number;
      }
      mesh_.vertices.push_back(position);
    }
    add_triangle(mesh_);
    return skip_words({"endloop", "endfacet"});
  }

  Status skip_words(std::initializer_list<std::string_view> keywords) {
    for (const std::string_view keyword : keywords) {
      const std::string_view word = extract_word(rest_);
      if (!equals_keyword(word, keyword)) return misplaced(word, keyword);
    }
    return {};
  }

  Error misplaced(std::string_view word, std::string_view expected) const {
    const std::string_view before = all_.substr(0, all_.size() - rest_.size());
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    return Error{ErrorCode::malformed, "line " + std::to_string(line) + " has '" +
                                           excerpt(std::string(word)) + "' instead of " +
                                           std::string(expected)};
  }

  std::string_view all_, rest_;
  FileMesh mesh_;
};

}  // namespace

Result<FileMesh> parse_stl(std::string_view bytes) {
  if (is_binary(bytes)) return read_binary(bytes);
  const std::string_view text = without_byte_order_mark(bytes);
  std::string_view start = text;
  if (!equals_keyword(extract_word(start), "solid")) {
    return Error{ErrorCode::malformed,
                 "its length does not match its count of triangles, and it does not begin with 'solid'"};
  }
  if (!ends_as_text(text)) {
    return Error{ErrorCode::malformed, "it does not end with 'endsolid'; it is cut or damaged"};
  }
  return TextReader(text).read();
}

}  // namespace spoonbill
