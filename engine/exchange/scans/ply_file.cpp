#include "engine/exchange/scans/ply_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/scans/number_lines.h"
#include "engine/exchange/scans/ply_header.h"
#include "engine/exchange/scans/polygon.h"

namespace spoonbill {
namespace {

// Reads the numbers after the header of a PLY file, one by one. The functions return false at the end of the
// file or if there is no number.
class PlyNumbers {
 public:
  explicit PlyNumbers(const PlyHeader& header)
      : rest_(header.body),
        is_text_(header.format == PlyFormat::text),
        swapped_((header.format == PlyFormat::big_endian) == (std::endian::native == std::endian::little)) {}

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

  // Reads the number of items of a list. It must be whole and at most the number of bytes that remain in the
  // file.
  bool read_length(NumberType type, std::size_t& length) {
    double number = 0.0;
    if (!read(type, number) || !(number >= 0.0) || number > static_cast<double>(rest_.size())) return false;
    length = static_cast<std::size_t>(number);
    return static_cast<double>(length) == number;
  }

  bool skip(const PlyProperty& property) {
    std::size_t count = 1;
    if (property.list_count && !read_length(*property.list_count, count)) return false;
    if (!is_text_) return skip_bytes(count, byte_count(property.type));
    for (; count > 0; --count) {
      word_ = extract_word(rest_);
      if (word_.empty()) return false;
    }
    return true;
  }

  // Skips rows of known size. Returns false if the file holds fewer rows.
  bool skip_bytes(std::uint64_t rows, std::size_t row_bytes) {
    if (row_bytes > 0 && rows > rest_.size() / row_bytes) return false;
    rest_.remove_prefix(rows * row_bytes);
    return true;
  }

  // Returns true if only padding (blanks or zeros) follows.
  bool is_at_end() const {
    return std::all_of(rest_.begin(), rest_.end(), [](char letter) {
      return letter == '\0' || letter == ' ' || (letter >= '\t' && letter <= '\r');
    });
  }

  std::size_t remaining_bytes() const { return rest_.size(); }
  bool is_text() const { return is_text_; }
  // Returns the word that was read last from a text file.
  std::string_view word() const { return word_; }

 private:
  std::string_view rest_, word_;
  bool is_text_, swapped_;
};

Error row_error(const PlyNumbers& numbers, const PlyElement& element, std::uint64_t row) {
  const std::string name =
      excerpt(element.name) + " " + std::to_string(row + 1) + " of " + std::to_string(element.rows);
  if (numbers.word().find(',') != std::string_view::npos) {
    return Error{ErrorCode::malformed, name + " has '" + excerpt(numbers.word()) +
                                           "', a number with a comma; write decimal points"};
  }
  return Error{ErrorCode::malformed, std::string("it ends ") +
                                         (numbers.is_text() ? "or has no number " : "") + "within " + name +
                                         "; it is cut or damaged"};
}

// Returns the smallest number of bytes that a row can have.
std::size_t least_row_bytes(const PlyNumbers& numbers, const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += numbers.is_text() ? 1 : byte_count(property.list_count.value_or(property.type));
  }
  return bytes;
}

// Returns an error if the file is too small for the rows, so that a header cannot request more memory than
// its file has. Rows without properties need no bytes.
Status check_row_count(const PlyNumbers& numbers, const PlyElement& element) {
  const std::size_t bytes = least_row_bytes(numbers, element);
  if (bytes == 0 || element.rows <= numbers.remaining_bytes() / bytes) return {};
  return row_error(numbers, element, numbers.remaining_bytes() / bytes);
}

Status skip_element(PlyNumbers& numbers, const PlyElement& element) {
  // A row without properties needs no bytes, so any number of such rows is allowed.
  if (element.properties.empty()) return {};
  if (Status held = check_row_count(numbers, element); !held) return held;
  if (!numbers.is_text() && !element.has_lists()) {
    numbers.skip_bytes(element.rows, least_row_bytes(numbers, element));
    return {};
  }
  for (std::uint64_t row = 0; row < element.rows; ++row) {
    for (const PlyProperty& property : element.properties) {
      if (!numbers.skip(property)) return row_error(numbers, element, row);
    }
  }
  return {};
}

// Returns an error if vertices have no coordinates, or if the file has too few bytes for them.
Status check_vertices(const PlyNumbers& numbers, const PlyElement& element) {
  for (const std::string_view name : {"x", "y", "z"}) {
    if (element.find(name, false) < 0) return Error{ErrorCode::missing, "its vertices have no x, y and z"};
  }
  return check_row_count(numbers, element);
}

// Calls receive(point, normal) for each vertex; the normal of an element without normals is zero.
template <class Receive>
Status read_vertices(PlyNumbers& numbers, const PlyElement& element, const Receive& receive) {
  static constexpr std::array<std::string_view, 6> names{"x", "y", "z", "nx", "ny", "nz"};
  // For each property, the index of the coordinate that it holds: 0 to 2 for x, y and z, 3 to 5 for the
  // normal, -1 for other properties.
  std::vector<int> coordinate(element.properties.size(), -1);
  for (int k = 0; k < 6; ++k) {
    const int column = element.find(names[k], false);
    if (column >= 0) coordinate[column] = k;
  }
  for (std::uint64_t row = 0; row < element.rows; ++row) {
    std::array<double, 6> values{};
    for (std::size_t p = 0; p < coordinate.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const bool is_read =
          coordinate[p] < 0 ? numbers.skip(property) : numbers.read(property.type, values[coordinate[p]]);
      if (!is_read) return row_error(numbers, element, row);
    }
    const Status received =
        receive(Vector3(values[0], values[1], values[2]), Vector3(values[3], values[4], values[5]));
    if (!received) return received;
  }
  return {};
}

bool has_normals(const PlyElement& element) {
  return element.find("nx", false) >= 0 && element.find("ny", false) >= 0 && element.find("nz", false) >= 0;
}

bool is_face(const PlyElement& element) {
  return element.name == "face" || element.name == "tristrips";
}

// Builder of a mesh from the elements of a file. Polygons are stored until all vertices are read, because the
// vertices may follow them.
class FileMeshBuilder {
 public:
  Status read_vertices_of(PlyNumbers& numbers, const PlyElement& element) {
    if (element.rows > 0xfffffff0U) return Error{ErrorCode::too_many, "has too many vertices"};
    if (Status held = check_vertices(numbers, element); !held) return held;
    mesh_.vertices.reserve(element.rows);
    return read_vertices(numbers, element, [&](const Vector3& point, const Vector3&) -> Status {
      mesh_.vertices.push_back(point);
      return {};
    });
  }

  Status read_faces(PlyNumbers& numbers, const PlyElement& element) {
    if (element.rows == 0) return {};
    const int indices = std::max(element.find("vertex_indices", true), element.find("vertex_index", true));
    if (indices < 0) {
      return Error{ErrorCode::missing, "its " + excerpt(element.name) + " has no list vertex_indices"};
    }
    if (Status held = check_row_count(numbers, element); !held) return held;
    const bool is_strip = element.name == "tristrips";
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const bool are_indices = p == static_cast<std::size_t>(indices);
        if (!(are_indices ? read_list(numbers, property) : numbers.skip(property))) {
          return row_error(numbers, element, row);
        }
      }
      if (Status added = is_strip ? add_strip() : add_face(); !added) return added;
    }
    return {};
  }

  Result<FileMesh> finish() && {
    const std::size_t count = mesh_.vertices.size();
    const auto is_beyond = [&](std::uint32_t corner) { return corner >= count; };
    const bool is_wrong =
        std::any_of(polygon_corners_.begin(), polygon_corners_.end(), is_beyond) ||
        std::any_of(mesh_.triangles.begin(), mesh_.triangles.end(), [&](const auto& corners) {
          return std::any_of(corners.begin(), corners.end(), is_beyond);
        });
    if (is_wrong) {
      return Error{ErrorCode::inconsistent,
                   "a face refers to a vertex that does not exist; the file is damaged"};
    }
    std::span<const std::uint32_t> rest = polygon_corners_;
    for (const std::size_t corners : polygon_sizes_) {
      cut_polygon(rest.first(corners), mesh_.vertices, mesh_.triangles);
      rest = rest.subspan(corners);
    }
    return std::move(mesh_);
  }

 private:
  bool read_list(PlyNumbers& numbers, const PlyProperty& property) {
    std::size_t count = 0;
    row_.clear();
    if (!numbers.read_length(*property.list_count, count)) return false;
    for (; count > 0; --count) {
      double number = 0.0;
      if (!numbers.read(property.type, number)) return false;
      row_.push_back(number);
    }
    return true;
  }

  static std::optional<std::uint32_t> index_of(double number) {
    if (!(number >= 0.0) || number >= 4294967295.0 || number != std::floor(number)) return {};
    return static_cast<std::uint32_t>(number);
  }

  static Error index_error(double number) {
    return Error{ErrorCode::malformed, "a face refers to vertex " + number_text(number) +
                                           ", which is not an index; the file is damaged"};
  }

  Status add_face() {
    if (row_.size() > face_corner_limit) {
      return Error{ErrorCode::too_many, "a face has " + std::to_string(row_.size()) +
                                            " corners, but at most " + std::to_string(face_corner_limit) +
                                            " can be read; export triangles"};
    }
    corners_.clear();
    for (const double number : row_) {
      const auto index = index_of(number);
      if (!index) return index_error(number);
      corners_.push_back(*index);
    }
    if (corners_.size() == 3) mesh_.triangles.push_back({corners_[0], corners_[1], corners_[2]});
    if (corners_.size() > 3) {
      polygon_corners_.insert(polygon_corners_.end(), corners_.begin(), corners_.end());
      polygon_sizes_.push_back(corners_.size());
    }
    return {};
  }

  // Adds the triangles of a row of strips. Every second triangle of a strip runs in the opposite direction.
  // Triangles with a repeated corner only connect parts of a strip and are skipped.
  Status add_strip() {
    corners_.clear();
    for (const double number : row_) {
      if (number == -1.0) {
        corners_.clear();
        continue;
      }
      const auto index = index_of(number);
      if (!index) return index_error(number);
      corners_.push_back(*index);
      if (corners_.size() < 3) continue;
      const std::size_t last = corners_.size() - 1;
      std::array<std::uint32_t, 3> corners{corners_[last - 2], corners_[last - 1], corners_[last]};
      if (last % 2 == 1) std::swap(corners[0], corners[1]);
      if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) {
        mesh_.triangles.push_back(corners);
      }
    }
    return {};
  }

  FileMesh mesh_;
  std::vector<double> row_;
  std::vector<std::uint32_t> corners_, polygon_corners_;
  std::vector<std::size_t> polygon_sizes_;
};

Status check_end(const PlyNumbers& numbers) {
  if (numbers.is_at_end()) return {};
  return Error{ErrorCode::inconsistent,
               "has numbers after the last row that its header states; the file is damaged"};
}

Result<FileMesh> read_ply_mesh(const PlyHeader& header) {
  PlyNumbers numbers(header);
  FileMeshBuilder builder;
  for (const PlyElement& element : header.elements) {
    Status read = element.name == "vertex" ? builder.read_vertices_of(numbers, element)
                  : is_face(element)       ? builder.read_faces(numbers, element)
                                           : skip_element(numbers, element);
    if (!read) return read.error();
  }
  if (Status ended = check_end(numbers); !ended) return ended.error();
  return std::move(builder).finish();
}

Result<PointCloud> read_ply_cloud(const PlyHeader& header) {
  PlyNumbers numbers(header);
  PointCollector collector;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") {
      if (Status skipped = skip_element(numbers, element); !skipped) return skipped.error();
      continue;
    }
    if (element.rows <= point_limit) {
      if (Status held = check_vertices(numbers, element); !held) return held.error();
    }
    if (Status begun = collector.begin(element.rows, has_normals(element)); !begun) return begun.error();
    const Status read = read_vertices(numbers, element, [&](const Vector3& point, const Vector3& normal) {
      return collector.add(point, normal);
    });
    if (!read) return read.error();
  }
  if (Status ended = check_end(numbers); !ended) return ended.error();
  return std::move(collector).finish();
}

}  // namespace

Result<std::variant<FileMesh, PointCloud>> parse_ply(std::string_view bytes) {
  const auto header = read_ply_header(bytes);
  if (!header) return header.error();
  const std::vector<PlyElement>& elements = header->elements;
  if (std::none_of(elements.begin(), elements.end(), [](const auto& e) { return e.name == "vertex"; })) {
    return Error{ErrorCode::missing, "its header declares no vertices"};
  }
  const bool has_faces = std::any_of(elements.begin(), elements.end(), [](const PlyElement& element) {
    return is_face(element) && element.rows > 0;
  });
  if (!has_faces) {
    auto cloud = read_ply_cloud(header.value());
    if (!cloud) return cloud.error();
    return std::variant<FileMesh, PointCloud>(std::move(cloud).value());
  }
  auto mesh = read_ply_mesh(header.value());
  if (!mesh) return mesh.error();
  return std::variant<FileMesh, PointCloud>(std::move(mesh).value());
}

}  // namespace spoonbill
