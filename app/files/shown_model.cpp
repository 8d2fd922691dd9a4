#include "app/files/shown_model.h"

#include <memory>
#include <utility>
#include <vector>

#include "app/files/cad_file.h"
#include "app/files/documents.h"
#include "app/files/scan_file.h"
#include "engine/exchange/document.h"
#include "engine/exchange/file_format.h"
#include "engine/fitting/point_discs.h"
#include "haptic/recording.h"
#include "haptic/recording_lines.h"
#include "haptic/script.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

// Smallest size of a model that can be shown: the diagonal of the box around it.
constexpr double smallest_shown_m = 1e-6;

Result<ShownModel> show_document(const std::filesystem::path& file) {
  const auto document = read_document_file(file);
  if (!document) return document.error();
  return show_scene(document->scene, file);
}

Result<ShownModel> show_recording(const std::filesystem::path& file) {
  const auto recording = read_recording(file);
  if (!recording) return recording.error();
  return show_scene(recording->header.document.scene, file);
}

Result<ShownModel> show_native(const std::filesystem::path& file) {
  const auto format = find_native_format(file);
  if (!format) return format.error();
  switch (format.value()) {
    case FileFormat::document:
      return show_document(file);
    case FileFormat::recording:
      return show_recording(file);
    case FileFormat::script: {
      const auto script = read_script(file);
      if (!script) return script.error();
      return show_document(script->model_file);
    }
    default:
      return Error{ErrorCode::unsupported, file.string() + ": is a material, which has no shape to draw"};
  }
}

Result<ShownModel> show_cad(const std::filesystem::path& file, const Progress& progress) {
  CadReading reading;
  reading.format = format_from_name(file);
  CadChild child;
  child.progress = progress;
  const auto model = read_cad_file(file, reading, child);
  if (!model) return model.error();
  Scene scene;
  for (const CadSurface& face : model->surfaces) {
    Body& body = scene.bodies.emplace_back();
    body.name = face.name;
    body.surface = face.surface;
    body.trims = face.trims;
    if (face.shell_thickness_m > 0.0) body.shell_thickness_m = face.shell_thickness_m;
  }
  auto shown = show_scene(scene, file);
  if (shown) shown->notes = model->notes;
  return shown;
}

Result<ShownModel> show_scan(const std::filesystem::path& file, const std::optional<LengthUnit>& unit) {
  MeshReading reading;
  reading.unit = unit;
  auto read = read_scan_file(file, reading);
  if (!read) return read.error();
  Scan& scan = read->scan;
  TriangleMesh mesh = scan.triangles.empty()
                          ? make_point_discs(scan, shown_point_limit)
                          : TriangleMesh{std::move(scan.points_m), std::move(scan.triangles)};
  const auto is_line = [](const TriangleCorners& at) {
    return at[0] == at[1] || at[1] == at[2] || at[2] == at[0];
  };
  std::erase_if(mesh.triangles, is_line);
  auto shown = show_scene({}, file);  // the tool with which a new document begins
  if (!shown || mesh.triangles.empty()) return shown;
  MeshSnapshot& drawn = shown->snapshot.bodies.emplace_back().mesh;
  drawn = make_mesh_snapshot(mesh);
  drawn.is_closed = false;
  if (!unit)
    shown->notes.push_back(file.filename().string() + ": its numbers are taken as " +
                           std::string(read->unit.name));
  return shown;
}

}  // namespace

Result<ShownModel> show_scene(const Scene& scene, const std::filesystem::path& source) {
  auto snapshot = make_scene_snapshot(scene);
  if (!snapshot) return snapshot.error().in(source.string());
  return ShownModel{std::move(snapshot).value(), scene.ground, {}};
}

Result<ShownModel> read_shown_model(const std::filesystem::path& file, const std::optional<LengthUnit>& unit,
                                    const Progress& progress) {
  const FileFormat format = format_from_name(file);
  Result<ShownModel> shown = is_cad(format)                        ? show_cad(file, progress)
                             : is_mesh(format) || is_cloud(format) ? show_scan(file, unit)
                                                                   : show_native(file);
  if (shown && shown->snapshot.bodies.empty())
    return Error{ErrorCode::missing, file.string() + ": has nothing to draw"};
  if (shown && !(drawn_bounds(shown->snapshot).size() >= smallest_shown_m))
    return Error{ErrorCode::out_of_range, file.string() +
                                              ": is smaller than 0.001 mm; scale it, or give the unit "
                                              "of a mesh or cloud with --unit"};
  return shown;
}

}  // namespace spoonbill
