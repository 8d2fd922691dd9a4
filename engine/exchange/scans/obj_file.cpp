#include "engine/exchange/scans/obj_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/scans/number_lines.h"
#include "engine/exchange/scans/polygon.h"

namespace spoonbill {
namespace {

constexpr std::size_t vertex_limit = 0xfffffff0U;

// Returns the form of a face's corner, such as "#/#" for "7/1" or "#//#" for "7//3"; empty if the corner does
// not end with a digit.
std::string corner_form(std::string_view corner) {
  std::string form;
  for (const char character : corner) {
    if (character == '/') {
      form += '/';
    } else if (form.empty() || form.back() == '/') {
      form += '#';
    }
  }
  const bool ends_with_digit =
      !corner.empty() && std::isdigit(static_cast<unsigned char>(corner.back())) != 0;
  return ends_with_digit ? form : std::string();
}

// Returns whether all corners of a face are written in the same form.
bool is_complete_face(std::string_view corners) {
  const std::string form = corner_form(extract_word(corners));
  std::size_t count = 1;
  for (std::string_view corner; !(corner = extract_word(corners)).empty(); ++count) {
    if (corner_form(corner) != form) return false;
  }
  return !form.empty() && count >= 3;
}

// Returns whether a line that no line feed ends is a whole one. A vertex or a normal needs three numbers, and
// a face three corners of the same form.
bool is_complete(std::string_view line) {
  const std::string_view keyword = extract_word(line);
  if (keyword == "f") return is_complete_face(line);
  if (keyword != "v" && keyword != "vn") return true;
  for (int axis = 0; axis < 3; ++axis) {
    if (extract_word(line).empty()) return false;
  }
  return true;
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : rest_(text) {}

  Result<FileMesh> read() {
    while (!rest_.empty()) {
      const bool is_last = rest_.find('\n') == std::string_view::npos;
      const std::string_view line = read_line();
      if (is_last && !is_complete(line)) return refuse("is not complete; it is cut or damaged");
      if (Status status = read_element(line); !status) return status.error();
    }
    return cut_faces();
  }

 private:
  // Returns the next line without its comment, together with the lines that continue it.
  std::string_view read_line() {
    ++line_;
    std::string_view line = extract_line(rest_);
    if (line.ends_with('\\')) {
      joined_.clear();
      while (line.ends_with('\\')) {
        joined_ += line.substr(0, line.size() - 1);
        joined_ += ' ';
        line = extract_line(rest_);
        ++line_;
      }
      joined_ += line;
      line = joined_;
    }
    return line.substr(0, line.find('#'));
  }

  Status read_element(std::string_view line) {
    const std::string_view keyword = extract_word(line);
    if (keyword == "v") return read_vertex(line);
    return keyword == "f" ? read_face(line) : Status();
  }

  Status read_vertex(std::string_view words) {
    Vector3 position;
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> number = parse_number(extract_word(words));
      if (!number) return refuse("is a vertex without three numbers");
      position[axis] = *number;
    }
    if (mesh_.vertices.size() >= vertex_limit) return Error{ErrorCode::too_many, "has too many vertices"};
    mesh_.vertices.push_back(position);
    return {};
  }

  Status read_face(std::string_view words) {
    const std::size_t first = corners_.size();
    for (std::string_view corner; !(corner = extract_word(words)).empty();) {
      const std::optional<std::uint32_t> vertex = read_corner(corner.substr(0, corner.find('/')));
      if (!vertex) {
        return refuse("has the corner '" + excerpt(std::string(corner)) +
                      "', which is no vertex of the file");
      }
      corners_.push_back(*vertex);
    }
    const std::size_t count = corners_.size() - first;
    if (count < 3) return refuse("is a face of fewer than three corners");
    if (count > face_corner_limit) {
      return refuse("is a face of more than " + std::to_string(face_corner_limit) + " corners");
    }
    faces_.push_back({count, line_});
    return {};
  }

  // Returns the index of a vertex, which may still have to come.
  std::optional<std::uint32_t> read_corner(std::string_view word) const {
    long long number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) return {};
    const long long index = number > 0 ? number - 1 : number + static_cast<long long>(mesh_.vertices.size());
    if (number == 0 || index < 0 || index >= static_cast<long long>(vertex_limit)) return {};
    return static_cast<std::uint32_t>(index);
  }

  Result<FileMesh> cut_faces() {
    if (faces_.empty()) return Error{ErrorCode::too_few, "has no faces; export a surface mesh"};
    std::span<const std::uint32_t> rest(corners_);
    for (const auto& [count, line] : faces_) {
      const auto corners = rest.first(count);
      rest = rest.subspan(count);
      line_ = line;
      if (std::any_of(corners.begin(), corners.end(),
                      [&](std::uint32_t corner) { return corner >= mesh_.vertices.size(); })) {
        return refuse("has a corner that is no vertex of the file");
      }
      cut_polygon(corners, mesh_.vertices, mesh_.triangles);
    }
    return std::move(mesh_);
  }

  Error refuse(const std::string& reason) const {
    return Error{ErrorCode::malformed, "line " + std::to_string(line_) + " " + reason};
  }

  struct Face {
    std::size_t corners = 0, line = 0;
  };

  std::string_view rest_;
  std::string joined_;
  std::size_t line_ = 0;
  FileMesh mesh_;
  std::vector<std::uint32_t> corners_;  // of all faces, one after the other
  std::vector<Face> faces_;
};

}  // namespace

Result<FileMesh> parse_obj_mesh(std::string_view bytes) {
  return ObjReader(without_byte_order_mark(bytes)).read();
}

}  // namespace spoonbill
