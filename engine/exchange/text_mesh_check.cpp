#include "engine/exchange/text_mesh_check.h"

#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>

#include "engine/base/text.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

// A line of a name as long as any.
constexpr std::size_t tail_bytes = 65536;

std::string_view last_line_of(std::string_view text) {
  const std::size_t end = text.find_last_of("\r\n");
  if (end != std::string_view::npos) text.remove_prefix(end + 1);
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  return text;
}

// As Assimp tells them apart: by the count of triangles behind a binary one's first 80 bytes.
bool is_binary_stl(const std::filesystem::path& file, std::uintmax_t size) {
  constexpr std::size_t head_bytes = 84, count_at = 80, triangle_bytes = 50;
  const std::string head = read_first_bytes(file, head_bytes);
  if (head.size() < head_bytes) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, head.data() + count_at, sizeof triangles);
  return head_bytes + triangle_bytes * static_cast<std::uintmax_t>(triangles) == size;
}

bool begins_as_text_stl(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string word(sizeof "solid" - 1, '\0');
  stream >> std::ws;
  return stream.read(word.data(), static_cast<std::streamsize>(word.size())) && word == "solid";
}

// "7", "7/1", "7//3" or "7/1/3": where its slashes and numbers stand; nothing where it ends with neither.
std::string form_of(std::string_view corner) {
  std::string form;
  for (const char letter : corner) {
    if (letter == '/') {
      form += '/';
    } else if (form.empty() || form.back() == '/') {
      form += '#';
    }
  }
  const bool ends_with_digit =
      !corner.empty() && std::isdigit(static_cast<unsigned char>(corner.back())) != 0;
  return ends_with_digit ? form : std::string();
}

bool is_whole_face(std::istream& words) {
  std::string corner, form;
  std::size_t corners = 0;
  for (; words >> corner; ++corners) {
    const std::string here = form_of(corner);
    if (here.empty() || (corners > 0 && here != form)) return false;
    form = here;
  }
  return corners >= 3;
}

bool has_three_words(std::istream& words) {
  std::string word;
  return static_cast<bool>(words >> word >> word >> word);
}

}  // namespace

Status check_text_stl(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(file, ignored);
  if (is_binary_stl(file, size) || !begins_as_text_stl(file)) return {};
  std::string tail = read_last_bytes(file, tail_bytes);
  while (!tail.empty() && static_cast<unsigned char>(tail.back()) <= ' ') tail.pop_back();
  if (last_line_of(tail).starts_with("endsolid")) return {};
  return Error{"it does not end with 'endsolid'; it is cut or damaged"};
}

Status check_last_obj_line(const std::filesystem::path& file) {
  const std::string tail = read_last_bytes(file, tail_bytes);
  const std::string_view last = last_line_of(tail);
  const std::string line(last.substr(0, last.find('#')));
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  const bool is_vector = keyword == "v" || keyword == "vn";
  if (is_vector ? has_three_words(words) : keyword != "f" || is_whole_face(words)) return {};
  return Error{"its last line is no whole " + std::string(is_vector ? "vector" : "face") + ": '" +
               excerpt(line) + "'; it is cut or damaged"};
}

}  // namespace spoonbill
