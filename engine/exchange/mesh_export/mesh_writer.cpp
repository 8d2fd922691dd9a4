#include "engine/exchange/mesh_export/mesh_writer.h"

#include <zip.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written in native byte order");

constexpr std::size_t part_bytes = std::size_t{1} << 20;

// Buffer that passes bytes to the sink in large parts. The sink's first error is stored; bytes after it are
// dropped.
class PartBuffer {
 public:
  explicit PartBuffer(const ByteSink& sink) : sink_(sink) {}

  PartBuffer& text(std::string_view more) {
    bytes_ += more;
    return flush_if_full();
  }
  template <class T>
  PartBuffer& raw(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return flush_if_full();
  }
  Status finish() {
    flush();
    return status_;
  }

 private:
  PartBuffer& flush_if_full() {
    if (bytes_.size() >= part_bytes) flush();
    return *this;
  }
  void flush() {
    if (status_.ok() && !bytes_.empty()) status_ = sink_(bytes_);
    bytes_.clear();
  }

  const ByteSink& sink_;
  std::string bytes_;
  Status status_;
};

struct Counts {
  std::size_t vertices = 0, triangles = 0;
};

Counts count_elements(const std::vector<NamedMesh>& meshes) {
  Counts counts;
  for (const NamedMesh& part : meshes) {
    counts.vertices += part.mesh.vertices_m.size();
    counts.triangles += part.mesh.triangles.size();
  }
  return counts;
}

Status write_stl(const std::vector<NamedMesh>& meshes, double unit_m, const ByteSink& sink) {
  PartBuffer parts(sink);
  std::array<char, 80> head{};
  const std::string_view words = "binary STL by Spoonbill";
  std::memcpy(head.data(), words.data(), words.size());
  parts.raw(head).raw(static_cast<std::uint32_t>(count_elements(meshes).triangles));
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

Status write_obj(const std::vector<NamedMesh>& meshes, double unit_m, const ByteSink& sink) {
  PartBuffer parts(sink);
  parts.text("# by Spoonbill\n");
  std::size_t first = 1;  // number of the mesh's first vertex; OBJ counts vertices of the whole file from 1
  for (const NamedMesh& part : meshes) {
    parts.text("o ").text(part.name).text("\n");
    for (const Vector3& vertex : part.mesh.vertices_m) {
      parts.text("v");
      for (int axis = 0; axis < 3; ++axis) parts.text(" ").text(number_text(vertex[axis] / unit_m));
      parts.text("\n");
    }
    for (const TriangleCorners& corners : part.mesh.triangles) {
      parts.text("f");
      for (const std::uint32_t corner : corners) parts.text(" ").text(std::to_string(first + corner));
      parts.text("\n");
    }
    first += part.mesh.vertices_m.size();
  }
  return parts.finish();
}

Status write_ply(const std::vector<NamedMesh>& meshes, double unit_m, const ByteSink& sink) {
  PartBuffer parts(sink);
  const Counts counts = count_elements(meshes);
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
  std::size_t first = 0;
  for (const NamedMesh& part : meshes) {
    for (const TriangleCorners& corners : part.mesh.triangles) {
      parts.raw(std::uint8_t{3});
      for (const std::uint32_t corner : corners) parts.raw(static_cast<std::int32_t>(first + corner));
    }
    first += part.mesh.vertices_m.size();
  }
  return parts.finish();
}

const char* const content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";

const char* const relationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

std::string escape_attribute(const std::string& text) {
  std::string escaped;
  for (const char character : text) {
    switch (character) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += character;
    }
  }
  return escaped;
}

// Asks the sink whether to continue, and stores the first error.
class StopCheck {
 public:
  explicit StopCheck(const ByteSink& sink) : sink_(sink) {}

  bool may_continue() {
    if (status_.ok()) status_ = sink_({});
    return status_.ok();
  }
  // Returns true if the writer may continue. Asks the sink only at every 16384th element.
  bool may_continue_at(std::size_t number) {
    constexpr std::size_t interval = 1 << 14;
    return number % interval == 0 ? may_continue() : status_.ok();
  }
  const Status& status() const { return status_; }

 private:
  const ByteSink& sink_;
  Status status_;
};

void add_object(const NamedMesh& part, std::size_t id, std::string& xml, StopCheck& stop_check) {
  constexpr double per_metre = 1e3;
  xml += "<object id=\"" + std::to_string(id) +
         (part.closed ? "\" type=\"model\" name=\"" : "\" type=\"surface\" name=\"") +
         escape_attribute(part.name) + "\"><mesh><vertices>\n";
  std::size_t written = 0;
  for (const Vector3& vertex : part.mesh.vertices_m) {
    if (!stop_check.may_continue_at(written++)) return;
    xml += "<vertex x=\"" + number_text(per_metre * vertex.x()) + "\" y=\"" +
           number_text(per_metre * vertex.y()) + "\" z=\"" + number_text(per_metre * vertex.z()) + "\"/>\n";
  }
  xml += "</vertices><triangles>\n";
  for (const TriangleCorners& corners : part.mesh.triangles) {
    if (!stop_check.may_continue_at(written++)) return;
    xml += "<triangle v1=\"" + std::to_string(corners[0]) + "\" v2=\"" + std::to_string(corners[1]) +
           "\" v3=\"" + std::to_string(corners[2]) + "\"/>\n";
  }
  xml += "</triangles></mesh></object>\n";
}

std::string model_xml(const std::vector<NamedMesh>& meshes, StopCheck& stop_check) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n";
  for (std::size_t k = 0; k < meshes.size(); ++k) add_object(meshes[k], k + 1, xml, stop_check);
  xml += "</resources>\n<build>\n";
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    xml += "<item objectid=\"" + std::to_string(k + 1) + "\"/>\n";
  }
  return xml + "</build>\n</model>\n";
}

// Zip archive in memory.
class Archive {
 public:
  Archive() {
    zip_error_t error;
    zip_error_init(&error);
    source_ = zip_source_buffer_create(nullptr, 0, 0, &error);
    if (source_ != nullptr) archive_ = zip_open_from_source(source_, ZIP_TRUNCATE, &error);
    if (archive_ != nullptr) {
      zip_source_keep(source_);
    } else if (source_ != nullptr) {
      zip_source_free(source_);
      source_ = nullptr;
    }
    zip_error_fini(&error);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  ~Archive() {
    if (archive_ != nullptr) zip_discard(archive_);
    if (source_ != nullptr) zip_source_free(source_);
  }

  // Adds a file. `text` must outlive pack().
  bool add(const char* name, const std::string& text) {
    if (archive_ == nullptr) return false;
    zip_source_t* content = zip_source_buffer(archive_, text.data(), text.size(), 0);
    if (content == nullptr) return false;
    if (zip_file_add(archive_, name, content, ZIP_FL_ENC_UTF_8) >= 0) return true;
    zip_source_free(content);
    return false;
  }

  // Compresses the files. Returns false on an error, after which the archive is unusable.
  bool pack(StopCheck& stop_check) {
    if (archive_ == nullptr) return false;
    const auto stops = [](zip_t*, void* state) {
      return static_cast<StopCheck*>(state)->may_continue() ? 0 : 1;
    };
    zip_register_cancel_callback_with_state(archive_, stops, nullptr, &stop_check);
    if (zip_close(archive_) != 0) return false;
    archive_ = nullptr;
    // The stop is checked here, because zip_close() ignores a stop request from the last call of its
    // callback.
    return stop_check.status().ok();
  }

  // Passes the bytes of the packed archive to the sink.
  Status send_to(const ByteSink& sink) {
    if (zip_source_open(source_) != 0) return Error{ErrorCode::unwritable, "the ZIP archive cannot be read"};
    std::string part(std::size_t{1} << 20, '\0');
    Status status;
    for (;;) {
      const zip_int64_t count = zip_source_read(source_, part.data(), part.size());
      if (count < 0) status = Error{ErrorCode::unwritable, "the ZIP archive cannot be read"};
      if (count <= 0) break;
      status = sink(std::string_view(part).substr(0, static_cast<std::size_t>(count)));
      if (!status.ok()) break;
    }
    zip_source_close(source_);
    return status;
  }

 private:
  zip_source_t* source_ = nullptr;
  zip_t* archive_ = nullptr;
};

Status write_three_mf(const std::vector<NamedMesh>& meshes, const ByteSink& sink) {
  SPOONBILL_ASSERT(static_cast<bool>(sink));
  StopCheck stop_check(sink);
  const std::string types = content_types, relations = relationships, model = model_xml(meshes, stop_check);
  if (!stop_check.status().ok()) return stop_check.status();
  Archive archive;
  if (!archive.add("[Content_Types].xml", types) || !archive.add("_rels/.rels", relations) ||
      !archive.add("3D/3dmodel.model", model) || !archive.pack(stop_check)) {
    return stop_check.status().ok() ? Error{ErrorCode::unwritable, "the ZIP archive cannot be written"}
                                    : stop_check.status();
  }
  return archive.send_to(sink);
}

}  // namespace

Status write_meshes(const std::vector<NamedMesh>& meshes, FileFormat format, double unit_m,
                    const ByteSink& sink) {
  SPOONBILL_ASSERT(unit_m > 0.0 && static_cast<bool>(sink));
  const Counts counts = count_elements(meshes);
  constexpr std::size_t index_limit = std::numeric_limits<std::int32_t>::max();
  if (counts.vertices > index_limit || counts.triangles > index_limit) {
    return Error{ErrorCode::too_many,
                 "has more triangles than the format can count; choose a larger chord error"};
  }
  SPOONBILL_ASSERT(is_written_mesh(format));
  switch (format) {
    case FileFormat::stl:
      return write_stl(meshes, unit_m, sink);
    case FileFormat::obj:
      return write_obj(meshes, unit_m, sink);
    case FileFormat::ply:
      return write_ply(meshes, unit_m, sink);
    default:
      return write_three_mf(meshes, sink);
  }
}

}  // namespace spoonbill
