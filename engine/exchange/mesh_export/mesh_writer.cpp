#include "engine/exchange/mesh_export/mesh_writer.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/exchange/mesh_export/three_mf.h"

namespace spoonbill {
namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written in the machine's order");

constexpr std::size_t part_bytes = std::size_t{1} << 20;

// Bytes on their way to a file; the first refusal sticks.
class Parts {
 public:
  explicit Parts(const TakeBytes& take) : take_(take) {}

  Parts& text(std::string_view more) {
    bytes_ += more;
    return passed_on();
  }
  template <class T>
  Parts& raw(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return passed_on();
  }
  Status finish() {
    pass_on();
    return status_;
  }

 private:
  Parts& passed_on() {
    if (bytes_.size() >= part_bytes) pass_on();
    return *this;
  }
  void pass_on() {
    if (status_.ok() && !bytes_.empty()) status_ = take_(bytes_);
    bytes_.clear();
  }

  const TakeBytes& take_;
  std::string bytes_;
  Status status_;
};

struct Counts {
  std::size_t vertices = 0, triangles = 0;
};

Counts counts_of(const std::vector<NamedMesh>& meshes) {
  Counts counts;
  for (const NamedMesh& part : meshes) {
    counts.vertices += part.mesh.vertices_m.size();
    counts.triangles += part.mesh.triangles.size();
  }
  return counts;
}

Status write_stl(const std::vector<NamedMesh>& meshes, double unit_m, const TakeBytes& take) {
  Parts parts(take);
  std::array<char, 80> head{};
  const std::string_view words = "binary STL by Spoonbill";
  std::memcpy(head.data(), words.data(), words.size());
  parts.raw(head).raw(static_cast<std::uint32_t>(counts_of(meshes).triangles));
  const auto add = [&](const Vector3& vector) {
    for (int axis = 0; axis < 3; ++axis) parts.raw(static_cast<float>(vector[axis]));
  };
  for (const NamedMesh& part : meshes) {
    for (const TriangleCorners& corners : part.mesh.triangles) {
      const Vector3 a = part.mesh.vertices_m[corners[0]], b = part.mesh.vertices_m[corners[1]],
                    c = part.mesh.vertices_m[corners[2]];
      const Vector3 normal = (b - a).cross(c - a).stableNormalized();
      add(normal.allFinite() ? normal : Vector3(Vector3::Zero()));
      for (const Vector3& corner : {a, b, c}) add(corner / unit_m);
      parts.raw(std::uint16_t{0});
    }
  }
  return parts.finish();
}

Status write_obj(const std::vector<NamedMesh>& meshes, double unit_m, const TakeBytes& take) {
  Parts parts(take);
  parts.text("# by Spoonbill\n");
  std::size_t before = 1;  // vertices count from 1 through the whole file
  for (const NamedMesh& part : meshes) {
    parts.text("o ").text(part.name).text("\n");
    for (const Vector3& vertex : part.mesh.vertices_m) {
      parts.text("v");
      for (int axis = 0; axis < 3; ++axis) parts.text(" ").text(number_text(vertex[axis] / unit_m));
      parts.text("\n");
    }
    for (const TriangleCorners& corners : part.mesh.triangles) {
      parts.text("f");
      for (const std::uint32_t corner : corners) parts.text(" ").text(std::to_string(before + corner));
      parts.text("\n");
    }
    before += part.mesh.vertices_m.size();
  }
  return parts.finish();
}

Status write_ply(const std::vector<NamedMesh>& meshes, double unit_m, const TakeBytes& take) {
  Parts parts(take);
  const Counts counts = counts_of(meshes);
  parts.text("ply\nformat binary_little_endian 1.0\ncomment by Spoonbill\nelement vertex ")
      .text(std::to_string(counts.vertices))
      .text("\nproperty double x\nproperty double y\nproperty double z\nelement face ")
      .text(std::to_string(counts.triangles))
      .text("\nproperty list uchar int vertex_indices\nend_header\n");
  for (const NamedMesh& part : meshes) {
    for (const Vector3& vertex : part.mesh.vertices_m) {
      for (int axis = 0; axis < 3; ++axis) parts.raw(vertex[axis] / unit_m);
    }
  }
  std::size_t before = 0;
  for (const NamedMesh& part : meshes) {
    for (const TriangleCorners& corners : part.mesh.triangles) {
      parts.raw(std::uint8_t{3});
      for (const std::uint32_t corner : corners) parts.raw(static_cast<std::int32_t>(before + corner));
    }
    before += part.mesh.vertices_m.size();
  }
  return parts.finish();
}

}  // namespace

Status write_meshes(const std::vector<NamedMesh>& meshes, FileFormat format, double unit_m,
                    const TakeBytes& take) {
  SPOONBILL_ASSERT(unit_m > 0.0 && static_cast<bool>(take));
  const Counts counts = counts_of(meshes);
  constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
  if (counts.vertices > most || counts.triangles > most) {
    return Error{"has more triangles than the format counts; choose a larger chord error"};
  }
  SPOONBILL_ASSERT(is_written_mesh(format));
  switch (format) {
    case FileFormat::stl:
      return write_stl(meshes, unit_m, take);
    case FileFormat::obj:
      return write_obj(meshes, unit_m, take);
    case FileFormat::ply:
      return write_ply(meshes, unit_m, take);
    default:
      return write_three_mf(meshes, take);
  }
}

}  // namespace spoonbill
