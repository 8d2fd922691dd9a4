#include "engine/exchange/mesh_export/three_mf.h"

#include <zip.h>

#include <cstdint>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

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

std::string attribute_text(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    switch (letter) {
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
        escaped += letter;
    }
  }
  return escaped;
}

// Whether whoever takes the bytes still wants them: the first refusal sticks.
class Going {
 public:
  explicit Going(const TakeBytes& take) : take_(take) {}

  bool on() {
    if (status_.ok()) status_ = take_({});
    return status_.ok();
  }
  // Not for each of what is written by the million.
  bool on_at(std::size_t number) {
    constexpr std::size_t between = 1 << 14;
    return number % between == 0 ? on() : status_.ok();
  }
  const Status& status() const { return status_; }

 private:
  const TakeBytes& take_;
  Status status_;
};

void add_object(const NamedMesh& part, std::size_t id, std::string& xml, Going& going) {
  constexpr double per_metre = 1e3;
  xml += "<object id=\"" + std::to_string(id) +
         (part.closed ? "\" type=\"model\" name=\"" : "\" type=\"surface\" name=\"") +
         attribute_text(part.name) + "\"><mesh><vertices>\n";
  std::size_t written = 0;
  for (const Vector3& vertex : part.mesh.vertices_m) {
    if (!going.on_at(written++)) return;
    xml += "<vertex x=\"" + number_text(per_metre * vertex.x()) + "\" y=\"" +
           number_text(per_metre * vertex.y()) + "\" z=\"" + number_text(per_metre * vertex.z()) + "\"/>\n";
  }
  xml += "</vertices><triangles>\n";
  for (const TriangleCorners& corners : part.mesh.triangles) {
    if (!going.on_at(written++)) return;
    xml += "<triangle v1=\"" + std::to_string(corners[0]) + "\" v2=\"" + std::to_string(corners[1]) +
           "\" v3=\"" + std::to_string(corners[2]) + "\"/>\n";
  }
  xml += "</triangles></mesh></object>\n";
}

std::string model_xml(const std::vector<NamedMesh>& meshes, Going& going) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n";
  for (std::size_t k = 0; k < meshes.size(); ++k) add_object(meshes[k], k + 1, xml, going);
  xml += "</resources>\n<build>\n";
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    xml += "<item objectid=\"" + std::to_string(k + 1) + "\"/>\n";
  }
  return xml + "</build>\n</model>\n";
}

// A zip that is put together in memory.
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

  // `text` must outlive pack().
  bool add(const char* name, const std::string& text) {
    if (archive_ == nullptr) return false;
    zip_source_t* content = zip_source_buffer(archive_, text.data(), text.size(), 0);
    if (content == nullptr) return false;
    if (zip_file_add(archive_, name, content, ZIP_FL_ENC_UTF_8) >= 0) return true;
    zip_source_free(content);
    return false;
  }

  // Nothing is left to be packed where it fails.
  bool pack(Going& going) {
    if (archive_ == nullptr) return false;
    const auto stops = [](zip_t*, void* asked) { return static_cast<Going*>(asked)->on() ? 0 : 1; };
    zip_register_cancel_callback_with_state(archive_, stops, nullptr, &going);
    if (zip_close(archive_) != 0) return false;
    archive_ = nullptr;
    // Asked for the last time, it has been packed.
    return going.status().ok();
  }

  // Of the packed archive.
  Status hand_to(const TakeBytes& take) {
    if (zip_source_open(source_) != 0) return Error{"cannot be packed"};
    std::string part(std::size_t{1} << 20, '\0');
    Status status;
    for (;;) {
      const zip_int64_t count = zip_source_read(source_, part.data(), part.size());
      if (count < 0) status = Error{"cannot be packed"};
      if (count <= 0) break;
      status = take(std::string_view(part).substr(0, static_cast<std::size_t>(count)));
      if (!status.ok()) break;
    }
    zip_source_close(source_);
    return status;
  }

 private:
  zip_source_t* source_ = nullptr;
  zip_t* archive_ = nullptr;
};

}  // namespace

Status write_three_mf(const std::vector<NamedMesh>& meshes, const TakeBytes& take) {
  SPOONBILL_ASSERT(static_cast<bool>(take));
  Going going(take);
  const std::string types = content_types, relations = relationships, model = model_xml(meshes, going);
  if (!going.status().ok()) return going.status();
  Archive archive;
  if (!archive.add("[Content_Types].xml", types) || !archive.add("_rels/.rels", relations) ||
      !archive.add("3D/3dmodel.model", model) || !archive.pack(going)) {
    return going.status().ok() ? Error{"cannot be packed"} : going.status();
  }
  return archive.hand_to(take);
}

}  // namespace spoonbill
