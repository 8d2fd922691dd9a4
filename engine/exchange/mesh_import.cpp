#include "engine/exchange/mesh_import.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/file.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/ply_check.h"
#include "engine/exchange/text_mesh_check.h"

namespace spoonbill {
namespace {

// Assimp 5.2 takes a line feed that begins the numbers of a binary PLY for the end of the header, and every
// number after it from a byte too far. True for such a file, whose numbers begin at `begin`.
bool begins_with_line_feed(const std::string& file, std::size_t& begin) {
  constexpr std::string_view last_line = "\nend_header\n";
  const std::string start = read_first_bytes(file, ply_header_bytes_limit);
  const std::size_t place = start.find(last_line);
  if (place == std::string::npos || start.find("\nformat binary") > place) return false;
  begin = place + last_line.size();
  return begin < start.size() && start[begin] == '\n';
}

// The file with a second line feed for Assimp to take.
class MendedStream final : public Assimp::MemoryIOStream {
 public:
  MendedStream(const std::string& file, std::size_t begin) : MendedStream(mended(file, begin)) {}

 private:
  explicit MendedStream(std::vector<std::uint8_t>&& bytes)
      : MemoryIOStream(bytes.data(), bytes.size()), bytes_(std::move(bytes)) {}

  static std::vector<std::uint8_t> mended(const std::string& file, std::size_t begin) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> bytes(std::filesystem::file_size(file) + 1, '\n');
    auto* letters = reinterpret_cast<char*>(bytes.data());
    stream.read(letters, static_cast<std::streamsize>(begin));
    stream.read(letters + begin + 1, static_cast<std::streamsize>(bytes.size() - begin - 1));
    return bytes;
  }

  std::vector<std::uint8_t> bytes_;  // moved, the bytes stay where they are
};

// Materials that a file names could be anything: a device, a pipe, a secret.
class OneFile final : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string file) : file_(std::move(file)) {}
  bool Exists(const char* name) const override { return file_ == name && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (file_ != name) return nullptr;
    std::size_t begin = 0;
    if (format_of(file_) == FileFormat::ply && begins_with_line_feed(file_, begin)) {
      return new MendedStream(file_, begin);
    }
    return DefaultIOSystem::Open(name, mode);
  }

 private:
  std::string file_;
};

bool names_ending(const char* endings, std::string_view ending) {
  std::istringstream words(endings != nullptr ? endings : "");
  for (std::string word; words >> word;) {
    if (word == ending) return true;
  }
  return false;
}

// Else a file that is none of its format is tried with every other importer there is.
void keep_importers_of(Assimp::Importer& importer, FileFormat format) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const aiImporterDesc* description = importer.GetImporterInfo(k);
    if (description != nullptr && names_ending(description->mFileExtensions, ending_of(format))) continue;
    importer.UnregisterLoader(importer.GetImporter(k));
  }
}

Status append(const aiMesh& from, const aiMatrix4x4& place, TriangleMesh& to) {
  const std::size_t first = to.vertices_m.size();
  if (first + from.mNumVertices > 0xfffffff0U) return Error{"has too many vertices"};
  for (unsigned v = 0; v < from.mNumVertices; ++v) {
    const aiVector3D at = place * from.mVertices[v];
    to.vertices_m.emplace_back(at.x, at.y, at.z);
  }
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) continue;
    TriangleCorners corners{};
    for (int k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= from.mNumVertices) return Error{"a triangle names a vertex that is not there"};
      corners[k] = static_cast<std::uint32_t>(first + face.mIndices[k]);
    }
    to.triangles.push_back(corners);
  }
  return {};
}

Result<TriangleMesh> gather(const aiScene& scene) {
  TriangleMesh mesh;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> waiting;
  if (scene.mRootNode != nullptr) waiting.emplace_back(scene.mRootNode, scene.mRootNode->mTransformation);
  while (!waiting.empty()) {
    const auto [node, place] = waiting.back();
    waiting.pop_back();
    for (unsigned m = 0; m < node->mNumMeshes; ++m) {
      if (Status status = append(*scene.mMeshes[node->mMeshes[m]], place, mesh); !status) {
        return status.error();
      }
    }
    for (unsigned c = node->mNumChildren; c-- > 0;) {
      const aiNode* child = node->mChildren[c];
      waiting.emplace_back(child, place * child->mTransformation);
    }
  }
  return mesh;
}

// What Assimp would not miss.
Status check_whole(const std::filesystem::path& file) {
  const FileFormat format = format_of(file);
  if (format == FileFormat::ply) return check_ply(file);
  if (format == FileFormat::stl) return check_text_stl(file);
  return format == FileFormat::obj ? check_last_obj_line(file) : Status();
}

}  // namespace

Result<TriangleMesh> import_mesh(const std::filesystem::path& file) {
  if (Status status = check_whole(file); !status.ok()) return status.error();
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(file.string()));  // the importer's from now on
  keep_importers_of(importer, format_of(file));
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr) return Error{importer.GetErrorString()};
  return gather(*scene);
}

}  // namespace spoonbill
