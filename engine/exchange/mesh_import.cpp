#include "engine/exchange/mesh_import.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

constexpr std::size_t ply_header_bytes_limit = 65536;

// Property of an element; a list is a count followed by that many numbers.
struct PlyProperty {
  bool is_list = false;
  std::size_t count_bytes = 0, bytes = 0;  // size of a list's count and of each number; 0: unknown type
};

struct PlyElement {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool is_text = false, is_big_endian = false;
  std::vector<PlyElement> elements;
};

// Returns the size of a type; 0 for an unknown name.
std::size_t number_bytes(const std::string& type) {
  static const std::map<std::string, std::size_t> known = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = known.find(type);
  return found == known.end() ? 0 : found->second;
}

// Reads the header and leaves the stream behind its last line.
Result<PlyHeader> read_ply_header(std::istream& stream) {
  PlyHeader header;
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
      PlyProperty property{name == "list", 0, number_bytes(name)};
      std::string count_type, type;
      if (property.is_list && words >> count_type >> type) {
        property.count_bytes = number_bytes(count_type);
        property.bytes = number_bytes(type);
      }
      header.elements.back().properties.push_back(property);
    }
  }
  return Error{ErrorCode::malformed, "its header has no end within 64 KiB; it is cut or not a PLY file"};
}

bool skip(std::istream& stream, std::uint64_t numbers) {
  std::string word;
  while (numbers > 0 && stream >> word) --numbers;
  return numbers == 0;
}

bool skip_list(std::istream& stream) {
  std::string word;
  if (!(stream >> word)) return false;
  const double count = std::strtod(word.c_str(), nullptr);
  return count >= 0.0 && count < 1e9 && skip(stream, static_cast<std::uint64_t>(count));
}

// Upper limit of the counts of rows and list entries: more than any file has, and too few to overflow.
constexpr std::uint64_t row_limit = std::uint64_t{1} << 32U;

bool skip_bytes(std::istream& stream, std::uint64_t bytes) {
  stream.ignore(static_cast<std::streamsize>(bytes));
  return static_cast<std::uint64_t>(stream.gcount()) == bytes;
}

bool skip_binary(std::istream& stream, const PlyProperty& property, bool is_big_endian) {
  if (!property.is_list) return skip_bytes(stream, property.bytes);
  std::uint64_t count = 0;
  for (std::size_t k = 0; k < property.count_bytes; ++k) {
    const int character = stream.get();
    if (character < 0) return false;
    const auto byte = static_cast<std::uint64_t>(character);
    count = is_big_endian ? count << 8U | byte : count | byte << (8U * k);
  }
  return count < row_limit && skip_bytes(stream, count * property.bytes);
}

bool skip_text(std::istream& stream, const PlyProperty& property) {
  return property.is_list ? skip_list(stream) : skip(stream, 1);
}

Status check_types(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) {
    if (property.bytes > 0 && (property.count_bytes > 0 || !property.is_list)) continue;
    return Error{ErrorCode::unknown,
                 "its " + excerpt(element.name) + " has a property of a type that PLY does not have"};
  }
  return {};
}

Error truncated_error(const PlyElement& element, std::uint64_t row) {
  return Error{ErrorCode::malformed, "it ends within " + excerpt(element.name) + " " +
                                         std::to_string(row + 1) + " of " + std::to_string(element.rows) +
                                         "; it is cut or damaged"};
}

// Returns the size of a row of a binary file; 0 if rows differ in size because of lists or text.
std::size_t fixed_row_bytes(const PlyHeader& header, const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (header.is_text || property.is_list) return 0;
    bytes += property.bytes;
  }
  return bytes;
}

Status check_rows(std::istream& stream, const PlyHeader& header, const PlyElement& element) {
  // Rows without properties need no bytes, however many rows the header promises.
  if (element.properties.empty()) return {};
  if (Status types = check_types(element); !types && !header.is_text) return types;
  if (const std::size_t bytes = fixed_row_bytes(header, element); bytes > 0) {
    if (element.rows > row_limit) return truncated_error(element, row_limit);
    const bool whole = skip_bytes(stream, element.rows * bytes);
    return whole ? Status() : truncated_error(element, static_cast<std::uint64_t>(stream.gcount()) / bytes);
  }
  for (std::uint64_t row = 0; row < element.rows; ++row) {
    for (const PlyProperty& property : element.properties) {
      if (header.is_text ? skip_text(stream, property)
                         : skip_binary(stream, property, header.is_big_endian)) {
        continue;
      }
      return truncated_error(element, row);
    }
  }
  return {};
}

// Number of bytes at the end of a file that are searched for its last line.
constexpr std::size_t tail_bytes = 65536;

std::string_view last_line(std::string_view text) {
  const std::size_t end = text.find_last_of("\r\n");
  if (end != std::string_view::npos) text.remove_prefix(end + 1);
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  return text;
}

// Returns true for binary STL, by the test that Assimp uses: the file's size matches the count of triangles
// after the first 80 bytes.
bool is_binary_stl(const std::filesystem::path& file, std::uintmax_t size) {
  constexpr std::size_t head_bytes = 84, count_offset = 80, triangle_bytes = 50;
  const std::string head = read_first_bytes(file, head_bytes);
  if (head.size() < head_bytes) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, head.data() + count_offset, sizeof triangles);
  return head_bytes + triangle_bytes * static_cast<std::uintmax_t>(triangles) == size;
}

bool begins_as_text_stl(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string word(sizeof "solid" - 1, '\0');
  stream >> std::ws;
  return stream.read(word.data(), static_cast<std::streamsize>(word.size())) && word == "solid";
}

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

bool is_complete_face(std::istream& words) {
  std::string corner, form;
  std::size_t corners = 0;
  for (; words >> corner; ++corners) {
    const std::string next = corner_form(corner);
    if (next.empty() || (corners > 0 && next != form)) return false;
    form = next;
  }
  return corners >= 3;
}

bool has_three_words(std::istream& words) {
  std::string word;
  return static_cast<bool>(words >> word >> word >> word);
}

// Returns true for a binary PLY whose data begin, at `begin`, with the byte of a line feed. Assimp 5.2 skips
// that byte as part of the header and reads all numbers one byte late.
bool begins_with_line_feed(const std::string& file, std::size_t& begin) {
  constexpr std::string_view last_line = "\nend_header\n";
  const std::string start = read_first_bytes(file, ply_header_bytes_limit);
  const std::size_t end = start.find(last_line);
  if (end == std::string::npos || start.find("\nformat binary") > end) return false;
  begin = end + last_line.size();
  return begin < start.size() && start[begin] == '\n';
}

// Content of a file with a second line feed inserted before its data; Assimp skips one of the two.
class PaddedStream final : public Assimp::MemoryIOStream {
 public:
  PaddedStream(const std::string& file, std::size_t begin) : PaddedStream(read_padded(file, begin)) {}

 private:
  explicit PaddedStream(std::vector<std::uint8_t>&& bytes)
      : MemoryIOStream(bytes.data(), bytes.size()), bytes_(std::move(bytes)) {}

  static std::vector<std::uint8_t> read_padded(const std::string& file, std::size_t begin) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> bytes(std::filesystem::file_size(file) + 1, '\n');
    auto* letters = reinterpret_cast<char*>(bytes.data());
    stream.read(letters, static_cast<std::streamsize>(begin));
    stream.read(letters + begin + 1, static_cast<std::streamsize>(bytes.size() - begin - 1));
    return bytes;
  }

  std::vector<std::uint8_t> bytes_;  // storage of the base class; moving keeps its address
};

// File system that contains only one file, because a material file that it names could be a device, a pipe or
// a secret.
class SingleFileIo final : public Assimp::DefaultIOSystem {
 public:
  explicit SingleFileIo(std::string file) : file_(std::move(file)) {}
  bool Exists(const char* name) const override { return file_ == name && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (file_ != name) return nullptr;
    std::size_t begin = 0;
    if (format_from_name(file_) == FileFormat::ply && begins_with_line_feed(file_, begin)) {
      return new PaddedStream(file_, begin);
    }
    return DefaultIOSystem::Open(name, mode);
  }

 private:
  std::string file_;
};

bool lists_ending(const char* endings, std::string_view ending) {
  std::istringstream words(endings != nullptr ? endings : "");
  for (std::string word; words >> word;) {
    if (word == ending) return true;
  }
  return false;
}

// Removes the importers of all other formats; Assimp tries each of them on a file that its own importer
// refuses.
void keep_importers(Assimp::Importer& importer, FileFormat format) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const aiImporterDesc* description = importer.GetImporterInfo(k);
    if (description != nullptr && lists_ending(description->mFileExtensions, usual_ending(format))) continue;
    importer.UnregisterLoader(importer.GetImporter(k));
  }
}

// Appends a mesh, moved by `transform`.
Status append(const aiMesh& from, const aiMatrix4x4& transform, TriangleMesh& to) {
  const std::size_t first = to.vertices_m.size();
  if (first + from.mNumVertices > 0xfffffff0U) return Error{ErrorCode::too_many, "has too many vertices"};
  for (unsigned v = 0; v < from.mNumVertices; ++v) {
    const aiVector3D point = transform * from.mVertices[v];
    to.vertices_m.emplace_back(point.x, point.y, point.z);
  }
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) continue;
    TriangleCorners corners{};
    for (int k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= from.mNumVertices) {
        return Error{ErrorCode::malformed, "a triangle names a vertex that does not exist"};
      }
      corners[k] = static_cast<std::uint32_t>(first + face.mIndices[k]);
    }
    to.triangles.push_back(corners);
  }
  return {};
}

Result<TriangleMesh> collect_triangles(const aiScene& scene) {
  TriangleMesh mesh;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> pending;
  if (scene.mRootNode != nullptr) pending.emplace_back(scene.mRootNode, scene.mRootNode->mTransformation);
  while (!pending.empty()) {
    const auto [node, transform] = pending.back();
    pending.pop_back();
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      if (Status status = append(*scene.mMeshes[node->mMeshes[m]], transform, mesh); !status) {
        return status.error();
      }
    }
    for (unsigned c = node->mNumChildren; c-- > 0;) {
      const aiNode* child = node->mChildren[c];
      pending.emplace_back(child, transform * child->mTransformation);
    }
  }
  return mesh;
}

// Checks for damage that Assimp does not report.
Status check_complete(const std::filesystem::path& file) {
  const FileFormat format = format_from_name(file);
  if (format == FileFormat::ply) return check_ply(file);
  if (format == FileFormat::stl) return check_text_stl(file);
  return format == FileFormat::obj ? check_last_obj_line(file) : Status();
}

}  // namespace

Status check_ply(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const Result<PlyHeader> header = read_ply_header(stream);
  if (!header.ok()) return header.error();
  for (const PlyElement& element : header->elements) {
    if (Status status = check_rows(stream, header.value(), element); !status.ok()) return status;
  }
  return {};
}

Status check_text_stl(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(file, ignored);
  if (is_binary_stl(file, size) || !begins_as_text_stl(file)) return {};
  std::string tail = read_last_bytes(file, tail_bytes);
  while (!tail.empty() && static_cast<unsigned char>(tail.back()) <= ' ') tail.pop_back();
  if (last_line(tail).starts_with("endsolid")) return {};
  return Error{ErrorCode::malformed, "it does not end with 'endsolid'; it is cut or damaged"};
}

Status check_last_obj_line(const std::filesystem::path& file) {
  const std::string tail = read_last_bytes(file, tail_bytes);
  const std::string_view end = last_line(tail);
  const std::string line(end.substr(0, end.find('#')));
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  const bool is_vector = keyword == "v" || keyword == "vn";
  if (is_vector ? has_three_words(words) : keyword != "f" || is_complete_face(words)) return {};
  return Error{ErrorCode::malformed, "its last line is not a complete " +
                                         std::string(is_vector ? "vector" : "face") + ": '" + excerpt(line) +
                                         "'; it is cut or damaged"};
}

Result<TriangleMesh> import_mesh(const std::filesystem::path& file) {
  if (Status status = check_complete(file); !status.ok()) return status.error();
  Assimp::Importer importer;
  importer.SetIOHandler(new SingleFileIo(file.string()));  // owned by the importer
  keep_importers(importer, format_from_name(file));
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr) return Error{ErrorCode::malformed, importer.GetErrorString()};
  return collect_triangles(*scene);
}

}  // namespace spoonbill
