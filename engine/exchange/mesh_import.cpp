#include "engine/exchange/mesh_import.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/scans/ply_file.h"

namespace spoonbill {
namespace {

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

// Returns the form of a face's corner in an OBJ file, such as "#/#" for "7/1" or "#//#" for "7//3"; empty if
// the corner does not end with a digit.
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

// File system that contains only one file. Other files that this file names, such as its materials, could be
// devices, pipes or secrets.
class SingleFileIo final : public Assimp::DefaultIOSystem {
 public:
  explicit SingleFileIo(std::string file) : file_(std::move(file)) {}
  bool Exists(const char* name) const override { return file_ == name && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (file_ != name) return nullptr;
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

// Removes the importers of all formats but `format`. Otherwise Assimp would try them on a file that the
// importer of `format` refuses.
void keep_importers(Assimp::Importer& importer, FileFormat format) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const aiImporterDesc* description = importer.GetImporterInfo(k);
    if (description != nullptr && lists_ending(description->mFileExtensions, usual_ending(format))) continue;
    importer.UnregisterLoader(importer.GetImporter(k));
  }
}

// Appends a mesh, transformed by `transform`.
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
        return Error{ErrorCode::malformed, "a triangle refers to a vertex that does not exist"};
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

Result<TriangleMesh> import_ply_mesh(const std::filesystem::path& file) {
  const auto bytes = read_file(file, point_file_bytes_limit);
  if (!bytes) return bytes.error();
  auto content = parse_ply(bytes.value());
  if (!content) return content.error();
  if (auto* mesh = std::get_if<PlyMesh>(&content.value())) {
    return TriangleMesh{std::move(mesh->vertices), std::move(mesh->triangles)};
  }
  return Error{ErrorCode::too_few, "has no triangles; export a surface mesh"};
}

// Checks for damage that Assimp does not report.
Status check_complete(const std::filesystem::path& file) {
  const FileFormat format = format_from_name(file);
  if (format == FileFormat::stl) return check_text_stl(file);
  return format == FileFormat::obj ? check_last_obj_line(file) : Status();
}

}  // namespace

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
  if (format_from_name(file) == FileFormat::ply) return import_ply_mesh(file);
  if (Status status = check_complete(file); !status.ok()) return status.error();
  Assimp::Importer importer;
  importer.SetIOHandler(new SingleFileIo(file.string()));  // owned by the importer
  keep_importers(importer, format_from_name(file));
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr) return Error{ErrorCode::malformed, importer.GetErrorString()};
  return collect_triangles(*scene);
}

}  // namespace spoonbill
