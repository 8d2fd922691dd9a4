#include "tests/app/mesh_texts.h"

#include <cstdint>
#include <cstring>
#include <sstream>

namespace spoonbill {
namespace {

template <class Number>
void append(std::string& bytes, Number number) {
  char parts[sizeof number];
  std::memcpy(parts, &number, sizeof number);
  bytes.append(parts, sizeof number);
}

void append(std::string& bytes, const Vector3& point) {
  for (int axis = 0; axis < 3; ++axis) append(bytes, static_cast<float>(point[axis]));
}

std::string ply_header(const TriangleMesh& mesh, const std::string& format) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(mesh.vertices_m.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const TriangleCorners& corners : mesh.triangles) {
    append(bytes, Vector3(0, 0, 0));
    for (const std::uint32_t corner : corners) append(bytes, mesh.vertices_m[corner]);
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ascii_stl(const TriangleMesh& mesh) {
  std::ostringstream text;
  text << "solid tool\n";
  for (const TriangleCorners& corners : mesh.triangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t corner : corners)
      text << "vertex " << mesh.vertices_m[corner].transpose() << "\n";
    text << "endloop\nendfacet\n";
  }
  text << "endsolid tool\n";
  return text.str();
}

std::string obj_text(const TriangleMesh& mesh) {
  std::ostringstream text;
  for (const Vector3& vertex : mesh.vertices_m) text << "v " << vertex.transpose() << "\n";
  for (const auto& [a, b, c] : mesh.triangles) text << "f " << a + 1 << " " << b + 1 << " " << c + 1 << "\n";
  return text.str();
}

std::string ply_text(const TriangleMesh& mesh) {
  std::ostringstream text;
  text << ply_header(mesh, "ascii");
  for (const Vector3& vertex : mesh.vertices_m) text << vertex.transpose() << "\n";
  for (const auto& [a, b, c] : mesh.triangles) text << "3 " << a << " " << b << " " << c << "\n";
  return text.str();
}

std::string binary_ply(const TriangleMesh& mesh) {
  std::string bytes = ply_header(mesh, "binary_little_endian");
  for (const Vector3& vertex : mesh.vertices_m) append(bytes, vertex);
  for (const TriangleCorners& corners : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : corners) append(bytes, static_cast<std::int32_t>(corner));
  }
  return bytes;
}

}  // namespace spoonbill
