#include "app/files/mesh_stream.h"

#include <algorithm>

namespace spoonbill {
namespace {

template <class T>
void write_bytes(std::ostream& out, const T* data, std::size_t count) {
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
}

}  // namespace

void write_mesh(std::ostream& out, const TriangleMesh& mesh) {
  const MeshStreamHead head{MeshStreamHead::mesh, mesh.vertices_m.size(), mesh.triangles.size()};
  write_bytes(out, &head, 1);
  write_bytes(out, mesh.vertices_m.data(), mesh.vertices_m.size());
  write_bytes(out, mesh.triangles.data(), mesh.triangles.size());
  out.flush();
}

void write_cloud(std::ostream& out, const PointCloud& cloud) {
  const MeshStreamHead head{MeshStreamHead::cloud, cloud.points.size(), cloud.normals.size()};
  const std::uint64_t skipped = cloud.skipped;
  write_bytes(out, &head, 1);
  write_bytes(out, &skipped, 1);
  write_bytes(out, cloud.points.data(), cloud.points.size());
  write_bytes(out, cloud.normals.data(), cloud.normals.size());
  out.flush();
}

void write_has_faces(std::ostream& out) {
  const MeshStreamHead head{MeshStreamHead::faces, 0, 0};
  write_bytes(out, &head, 1);
  out.flush();
}

void write_failure(std::ostream& out, const std::string& message) {
  std::string line = message.substr(0, MeshStreamHead::longest_failure);
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return letter < ' ' || letter > '~'; }, ' ');
  const MeshStreamHead head{MeshStreamHead::failure, line.size(), 0};
  write_bytes(out, &head, 1);
  write_bytes(out, line.data(), line.size());
  out.flush();
}

}  // namespace spoonbill
