#include "app/files/conversion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

#include "app/files/documents.h"
#include "app/report/quantity_text.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/document.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/mesh_export/mesh_writer.h"
#include "engine/exchange/mesh_export/tessellation.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

constexpr double default_chord_m = 5e-5, default_cad_tolerance_m = 1e-5;
// Fractions of the work that are done once the file is read, and once the faces of solids are joined.
constexpr double read_fraction = 0.5, joined_fraction = 0.7;

// A request with the formats of its files.
struct ConversionJob {
  const ConversionRequest& request;
  FileFormat in = format_from_name(request.in), out = format_from_name(request.out);
};

Error file_error(ErrorCode code, const std::filesystem::path& file, const std::string& message,
                 const std::string& field = {}) {
  return Error{code, file.string() + ": " + message, field};
}

bool is_model(FileFormat format) {
  return format == FileFormat::document || is_cad(format);
}

Status check_formats(const ConversionJob& job) {
  const auto& [request, in, out] = job;
  const std::string known = ".json, .step, .stp, .iges, .igs";
  if (!is_model(in) && !is_written_mesh(in)) {
    return file_error(ErrorCode::unsupported, request.in,
                      "does not have the ending of a model that can be read: " + known);
  }
  if (is_written_mesh(in)) {
    return file_error(ErrorCode::unsupported, request.in,
                      "is a mesh, which has no B-splines; fit a surface to it with `spoonbill fit`");
  }
  if (!is_model(out) && !is_written_mesh(out)) {
    return file_error(
        ErrorCode::unsupported, request.out,
        "does not have the ending of a format that can be written: " + known + ", .stl, .obj, .ply, .3mf");
  }
  if (in == FileFormat::document && out == FileFormat::document && request.bodies.empty()) {
    return file_error(ErrorCode::inconsistent, request.out,
                      "is a document, as the input is; choose another ending, or select bodies with --bodies",
                      "--bodies");
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(request.in, request.out, ignored)) {
    return file_error(ErrorCode::inconsistent, request.out, "is the input file; choose another name");
  }
  return {};
}

// Rejects options that would have no effect.
Status check_options(const ConversionJob& job) {
  const auto& [request, in, out] = job;
  if (request.unit && in == FileFormat::document && out == FileFormat::document) {
    return file_error(ErrorCode::inconsistent, request.out,
                      "is in millimetres, as the input document is; remove --unit", "--unit");
  }
  if (request.chord_m && !is_written_mesh(out)) {
    return file_error(ErrorCode::inconsistent, request.out,
                      "is not a mesh, and only meshes have a chord error; remove --chord", "--chord");
  }
  if (request.allow_deviation && !is_written_mesh(out)) {
    return file_error(ErrorCode::inconsistent, request.out,
                      "is not a mesh, and only meshes deviate; remove --allow-deviation",
                      "--allow-deviation");
  }
  if (request.tolerance_m && !is_cad(in)) {
    return file_error(ErrorCode::inconsistent, request.in, "is converted exactly; remove --tolerance",
                      "--tolerance");
  }
  if (request.sew_m && !is_cad(in)) {
    return file_error(ErrorCode::inconsistent, request.in,
                      "is not a CAD file, and only faces of CAD files are joined; remove --sew", "--sew");
  }
  if (request.schema && out != FileFormat::step) {
    return file_error(ErrorCode::inconsistent, request.out,
                      "is not a STEP file, and only STEP files have a schema; remove --schema", "--schema");
  }
  if (request.unit && out == FileFormat::three_mf) {
    return file_error(ErrorCode::inconsistent, request.out, "3MF is written in millimetres; remove --unit",
                      "--unit");
  }
  if (request.unit && is_cad(in) && out != FileFormat::document) {
    return file_error(ErrorCode::inconsistent, request.out,
                      "--unit is ambiguous between two files with a unit; convert to .json first", "--unit");
  }
  return {};
}

CadModel model_from_bodies(std::vector<Body> bodies) {
  std::vector<std::string> names;
  names.reserve(bodies.size());
  for (const Body& body : bodies) names.push_back(body.name);
  names = make_names_unique(names, "body");
  CadModel model;
  model.unit = millimetre.name;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    Body& body = bodies[k];
    CadSurface surface;
    surface.name = std::move(names[k]);
    surface.surface = std::move(body.surface);
    surface.trims = std::move(body.trims);
    surface.shell_thickness_m = body.shell_thickness_m.value_or(0.0);
    surface.solid = std::move(body.solid);
    model.surfaces.push_back(std::move(surface));
  }
  return model;
}

// Replaces the items by those selected in request.bodies, in the order of the selection.
template <class Item>
Status select_bodies(const ConversionRequest& request, std::vector<Item>& items) {
  if (request.bodies.empty()) return {};
  std::vector<Item> chosen;
  for (const int number : request.bodies) {
    if (static_cast<std::size_t>(number) > items.size()) {
      return file_error(ErrorCode::out_of_range, request.in,
                        "has " + count_text(items.size(), "body", "bodies") + ", and --bodies names " +
                            std::to_string(number),
                        "--bodies");
    }
    chosen.push_back(items[static_cast<std::size_t>(number) - 1]);
  }
  items = std::move(chosen);
  return {};
}

// Reads all bodies. Refuses a document if a selected body has a mesh.
Result<CadModel> read_model(const ConversionJob& job, const CadChild& child) {
  const ConversionRequest& request = job.request;
  if (job.in == FileFormat::document) {
    auto document = read_document(request.in);
    if (!document) return document.error();
    std::vector<Body> selected = document->scene.bodies;
    if (Status chosen = select_bodies(request, selected); !chosen) return chosen.error();
    if (Status surfaces = check_surfaces(selected, request.in); !surfaces) return surfaces.error();
    return model_from_bodies(std::move(document->scene.bodies));
  }
  CadReading reading;
  reading.format = job.in;
  reading.tolerance_m = request.tolerance_m.value_or(default_cad_tolerance_m);
  reading.sew_m = request.sew_m.value_or(0.0);
  if (request.unit) reading.unit_m = request.unit->metres;
  auto model = read_cad_file(request.in, reading, child);
  if (!model) return model.error();
  return model;
}

std::vector<std::string> list_shell_notes(const CadModel& model) {
  std::vector<std::string> notes;
  for (const CadSurface& part : model.surfaces) {
    if (part.shell_thickness_m <= 0.0) continue;
    notes.push_back("'" + part.name + "' is a shell of " + number_text(1e3 * part.shell_thickness_m) +
                    " mm; its surface is written without the thickness");
  }
  return notes;
}

Status write_model(const CadModel& model, const ConversionJob& job, const CadChild& child,
                   ConversionReport& report) {
  const ConversionRequest& request = job.request;
  CadWriting writing;
  writing.format = job.out;
  writing.schema = request.schema.value_or(StepSchema::ap214);
  writing.unit = request.unit.value_or(millimetre).name;
  const auto content = make_cad_file(model, writing, request.out, child);
  if (!content) return content.error();
  report.unit_out = writing.unit;
  report.solids = content->solids;
  report.open_shells = content->open_shells;
  for (std::string& note : list_shell_notes(model)) report.notes.push_back(std::move(note));
  report.notes.insert(report.notes.end(), content->notes.begin(), content->notes.end());
  return write_file(request.out, content->text, Durability::now, request.how);
}

CadChild make_child(const ConversionRequest& request, const Progress& progress) {
  CadChild child;
  child.program = request.cad_program;
  child.progress = progress;
  return child;
}

bool is_face_of_solid(const CadSurface& surface) {
  return !surface.solid.empty();
}

struct ModelMeshing {
  double chord_m = default_chord_m;
  bool allow_deviation = false;
  std::filesystem::path file;  // file to name in messages
  CadChild child;              // child process that joins the faces of solids
  Progress progress;           // progress of the meshing
};

struct ModelMeshes {
  std::vector<NamedMesh> meshes;  // meshes with unique names
  double chord_error_m = 0.0;
  std::vector<std::string> notes;
};

class Mesher {
 public:
  Mesher(const CadModel& model, const ModelMeshing& meshing) : model_(model), meshing_(meshing) {}

  Status mesh() {
    CadSolids solids = join_solids();
    std::map<std::size_t, CadSolid*> starts;
    for (CadSolid& solid : solids.solids) starts[solid.surface_indices.front()] = &solid;
    const std::set<std::size_t> loose(solids.loose.begin(), solids.loose.end());
    for (std::size_t k = 0; k < model_.surfaces.size(); ++k) {
      if (const auto solid = starts.find(k); solid != starts.end()) {
        const double gap_m = solid->second->gap_m, error_m = solid->second->chord_error_m;
        NamedMesh mesh{solid->second->name, std::move(solid->second->mesh), true};
        if (Status added = add(std::move(mesh), error_m, gap_m); !added) return added;
      }
      if (loose.contains(k)) {
        if (Status added = add_single_surface(k); !added) return added;
      }
      meshing_.progress.report(fraction_after(k + 1));
    }
    return {};
  }

  ModelMeshes finish() {
    std::vector<std::string> names;
    for (const NamedMesh& mesh : made_.meshes) names.push_back(mesh.name);
    names = make_names_unique(names, "body");
    for (std::size_t k = 0; k < names.size(); ++k) made_.meshes[k].name = std::move(names[k]);
    return std::move(made_);
  }

 private:
  // Returns the fraction of the work that is done once this number of surfaces is meshed. Writing the file
  // counts as one more surface.
  double fraction_after(std::size_t surfaces) const {
    return static_cast<double>(surfaces) / static_cast<double>(model_.surfaces.size() + 1);
  }

  CadSolids join_solids() {
    CadSolids none;
    none.loose.resize(model_.surfaces.size());
    std::iota(none.loose.begin(), none.loose.end(), std::size_t{0});
    if (std::none_of(model_.surfaces.begin(), model_.surfaces.end(), is_face_of_solid)) return none;
    auto found =
        make_cad_solids(model_, {meshing_.chord_m, exported_triangle_limit}, meshing_.file, meshing_.child);
    if (!found) {
      made_.notes.push_back("the faces of solids are not joined; each is a separate mesh: " +
                            found.error().message);
      return none;
    }
    for (const CadSolid& solid : found->solids) triangles_ += solid.mesh.triangles.size();
    made_.notes = found->notes;
    const auto loose = std::count_if(found->loose.begin(), found->loose.end(),
                                     [&](std::size_t k) { return is_face_of_solid(model_.surfaces[k]); });
    if (loose > 0) {
      made_.notes.push_back("faces that are not part of a solid: " + std::to_string(loose) +
                            ", each a separate mesh");
    }
    return std::move(found).value();
  }

  Status add_single_surface(std::size_t k) {
    const CadSurface& part = model_.surfaces[k];
    const std::size_t left = exported_triangle_limit - std::min(triangles_, exported_triangle_limit);
    // The mesh of a shell contains its surface twice and the walls between, so each of these three parts gets
    // a third of the limit.
    const std::size_t limit = part.shell_thickness_m > 0.0 ? left / 3 : left;
    const double before = fraction_after(k);
    auto alone =
        tessellate(part.surface, part.trims, meshing_.chord_m, limit, meshing_.progress.part(before, before));
    const std::string file = meshing_.file.string();
    if (!meshing_.progress.report(before)) return Error{ErrorCode::cancelled, file + ": stopped"};
    if (!alone) return alone.error().in("'" + part.name + "'").in(file);
    if (part.shell_thickness_m > 0.0) make_shell(part, alone.value());
    triangles_ += alone->mesh.triangles.size();
    return add({part.name, std::move(alone->mesh), alone->closed}, alone->chord_error_m, closing_tolerance_m);
  }

  void make_shell(const CadSurface& part, Tessellation& tessellation) {
    auto shell = thicken_mesh(tessellation.mesh, part.shell_thickness_m);
    if (shell) {
      tessellation.mesh = std::move(shell).value();
      tessellation.closed = true;
    } else {
      made_.notes.push_back("'" + part.name +
                            "' is written as its surface without the thickness: " + shell.error().message);
    }
  }

  // `gap_m` is the width of gaps that the mesh closes, by which it may exceed the chord error.
  Status add(NamedMesh mesh, double chord_error_m, double gap_m) {
    if (!meshing_.allow_deviation && chord_error_m > meshing_.chord_m + gap_m) {
      return file_error(ErrorCode::mismatch, meshing_.file,
                        "the mesh of '" + mesh.name + "' is within " + short_length_text(chord_error_m) +
                            " of the surface, not within " + short_length_text(meshing_.chord_m) +
                            "; choose a larger --chord, or add --allow-deviation",
                        "--chord");
    }
    made_.chord_error_m = std::max(made_.chord_error_m, chord_error_m);
    made_.meshes.push_back(std::move(mesh));
    return {};
  }

  const CadModel& model_;
  const ModelMeshing& meshing_;
  ModelMeshes made_;
  std::size_t triangles_ = 0;
};

// Meshes all surfaces in their order. A solid that consists of several surfaces becomes one mesh, at the
// position of its first surface. The mesh of a shell has both sides of the surface and the walls between
// them.
Result<ModelMeshes> mesh_model(const CadModel& model, const ModelMeshing& meshing) {
  Mesher mesher(model, meshing);
  if (Status meshed = mesher.mesh(); !meshed) return meshed.error();
  return mesher.finish();
}

Status write_mesh_file(const CadModel& model, const ConversionJob& job, const Progress& progress,
                       ConversionReport& report) {
  const ConversionRequest& request = job.request;
  const LengthUnit unit = request.unit.value_or(job.out == FileFormat::ply ? metre : millimetre);
  ModelMeshing meshing;
  meshing.chord_m = request.chord_m.value_or(default_chord_m);
  meshing.allow_deviation = request.allow_deviation;
  meshing.file = request.out;
  meshing.child = make_child(request, progress.part(read_fraction, joined_fraction));
  meshing.progress = progress.part(joined_fraction, 1.0);
  auto made = mesh_model(model, meshing);
  if (!made) return made.error();
  report.notes.insert(report.notes.end(), made->notes.begin(), made->notes.end());
  report.chord_error_m = made->chord_error_m;
  report.meshes = made->meshes.size();
  report.triangles = report.closed_meshes = 0;
  for (const NamedMesh& mesh : made->meshes) {
    *report.triangles += mesh.mesh.triangles.size();
    *report.closed_meshes += mesh.closed ? 1 : 0;
  }
  report.unit_out = unit.name;
  auto out = OutputFile::create(request.out, request.how);
  if (!out) return out.error();
  // Errors of `out` contain the name of the file; errors of write_meshes() itself do not.
  Status file_status;
  const Status written = write_meshes(made->meshes, job.out, unit.metres, [&](std::string_view bytes) {
    file_status = progress.report(1.0) ? out->write(bytes)
                                       : Status(file_error(ErrorCode::cancelled, request.out, "stopped"));
    return file_status;
  });
  if (!file_status) return file_status;
  return written ? out->commit() : Status(written.error().in(request.out.string()));
}

Status write_native(const CadModel& model, const ConversionRequest& request, ConversionReport& report) {
  const auto document = make_cad_document(model, clean_cad_name(request.out.stem().string(), "model"));
  if (!document) return document.error().in(request.in.string());
  report.unit_out = "mm";
  const std::size_t bodies = document->scene.bodies.size();
  if (bodies > static_cast<std::size_t>(sculpted_body_count_range.high)) {
    report.notes.push_back("of these " + std::to_string(bodies) + " bodies at most " +
                           std::to_string(sculpted_body_count_range.high) +
                           " can be sculpted together; choose some with --bodies 1,3-5");
  }
  return write_document(document.value(), request.out, request.how);
}

// Copies the requested bodies of a document unchanged.
Result<ConversionReport> convert_document(const ConversionRequest& request) {
  auto document = read_document(request.in);
  if (!document) return document.error();
  if (Status chosen = select_bodies(request, document->scene.bodies); !chosen) return chosen.error();
  ConversionReport report;
  if (const std::string note = drop_unfit_trial(document->scene); !note.empty()) report.notes.push_back(note);
  if (Status written = write_document(document.value(), request.out, request.how); !written)
    return written.error();
  report.unit_in = report.unit_out = millimetre.name;
  std::erase_if(document->scene.bodies, [](const Body& body) { return body.mesh != nullptr; });
  report.surfaces = model_from_bodies(std::move(document->scene.bodies)).surfaces;
  return report;
}

Result<ConversionReport> write_and_report(CadModel model, const ConversionJob& job,
                                          const Progress& progress) {
  const ConversionRequest& request = job.request;
  ConversionReport report;
  report.unit_in = model.unit;
  report.unit_declared = model.unit_declared;
  report.notes.insert(report.notes.end(), model.notes.begin(), model.notes.end());
  if (!progress.report(read_fraction)) return file_error(ErrorCode::cancelled, request.out, "stopped");
  const Status written =
      job.out == FileFormat::document ? write_native(model, request, report)
      : is_cad(job.out)
          ? write_model(model, job, make_child(request, progress.part(read_fraction, 1.0)), report)
          : write_mesh_file(model, job, progress, report);
  if (!written) return written.error();
  report.surfaces = std::move(model.surfaces);
  progress.report(1.0);
  return report;
}

}  // namespace

bool is_exported_to(const std::filesystem::path& file) {
  const FileFormat format = format_from_name(file);
  return is_cad(format) || is_written_mesh(format);
}

Result<ConversionReport> export_bodies(std::vector<Body> bodies, const std::filesystem::path& out,
                                       const Progress& progress) {
  ConversionRequest request;
  request.out = out;
  if (!is_exported_to(out)) {
    return file_error(ErrorCode::unsupported, out, "does not have the ending of an export format");
  }
  for (const Body& body : bodies) {
    if (!body.mesh) continue;
    return file_error(ErrorCode::unsupported, out,
                      "cannot be written, because the body \"" + body.name +
                          "\" has a mesh; save the document, and convert its other bodies with "
                          "`spoonbill convert --bodies`");
  }
  return write_and_report(model_from_bodies(std::move(bodies)), {request}, progress);
}

Result<ConversionReport> convert_file(const ConversionRequest& request, const Progress& progress) {
  const ConversionJob job{request};
  if (Status formats = check_formats(job); !formats) return formats.error();
  if (Status options = check_options(job); !options) return options.error();
  if (job.in == FileFormat::document && job.out == FileFormat::document) {
    return convert_document(request);
  }
  auto model = read_model(job, make_child(request, progress.part(0.0, read_fraction)));
  if (!model) return model.error();
  if (Status chosen = select_bodies(request, model->surfaces); !chosen) return chosen.error();
  return write_and_report(std::move(model).value(), job, progress);
}

}  // namespace spoonbill
