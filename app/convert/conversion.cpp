#include "app/convert/conversion.h"

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "app/convert/cad_document.h"
#include "app/convert/model_meshes.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/base/file.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/document.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/mesh_export/mesh_writer.h"

namespace spoonbill {
namespace {

constexpr double usual_chord_m = 5e-5, default_tolerance_m = 1e-5;
// Of the whole work; writing takes the rest.
constexpr double share_of_reading = 0.5, share_of_solids = 0.7;

// A request and the formats that its names stand for.
struct Job {
  const ConversionRequest& request;
  FileFormat in = format_from_name(request.in), out = format_from_name(request.out);
};

Error about(const std::filesystem::path& file, const std::string& message) {
  return Error{file.string() + ": " + message};
}

bool is_model(FileFormat format) {
  return format == FileFormat::document || is_cad(format);
}

Status check_formats(const Job& job) {
  const auto& [request, in, out] = job;
  const std::string known = ".json, .step, .stp, .iges, .igs";
  if (!is_model(in) && !is_written_mesh(in)) {
    return about(request.in, "is no model by its name; " + known + " are read");
  }
  if (is_written_mesh(in)) {
    return about(request.in, "is a mesh, which has no B-splines; fit a surface to it with `spoonbill fit`");
  }
  if (!is_model(out) && !is_written_mesh(out)) {
    return about(request.out, "names no format; " + known + ", .stl, .obj, .ply and .3mf are written");
  }
  if (in == FileFormat::document && out == FileFormat::document && request.bodies.empty()) {
    return about(
        request.out,
        "is a document like the one that is read; choose another ending, or some bodies with --bodies");
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(request.in, request.out, ignored)) {
    return about(request.out, "is the file that is read; choose another name");
  }
  return {};
}

// An option that changes nothing is a mistake.
Status check_options(const Job& job) {
  const auto& [request, in, out] = job;
  if (request.unit && in == FileFormat::document && out == FileFormat::document) {
    return about(request.out, "is in millimetres like the document that is read; leave --unit out");
  }
  if (request.chord_m && !is_written_mesh(out)) {
    return about(request.out, "is no mesh, which has no chord error; leave --chord out");
  }
  if (request.tolerance_m && !is_cad(in)) {
    return about(request.in, "is taken exactly; leave --tolerance out");
  }
  if (request.schema && out != FileFormat::step) {
    return about(request.out, "is no STEP file, which alone has a schema; leave --schema out");
  }
  if (request.unit && out == FileFormat::three_mf) {
    return about(request.out, "3MF is written in millimetres; leave --unit out");
  }
  if (request.unit && is_cad(in) && out != FileFormat::document) {
    return about(request.out, "of two files with a unit --unit could mean either; convert to .json first");
  }
  return {};
}

CadModel model_of(std::vector<Body> bodies) {
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

Result<CadModel> read_model(const Job& job, const CadChild& child) {
  const ConversionRequest& request = job.request;
  if (job.in == FileFormat::document) {
    auto document = read_document(request.in);
    if (!document) return document.error();
    return model_of(std::move(document->scene.bodies));
  }
  CadReading reading;
  reading.format = job.in;
  reading.tolerance_m = request.tolerance_m.value_or(default_tolerance_m);
  if (request.unit) reading.unit_m = request.unit->metres;
  auto model = read_cad_file(request.in, reading, child);
  if (!model) return model.error();
  return model;
}

// Those that were asked for, in that order.
template <class Item>
Status choose(const ConversionRequest& request, std::vector<Item>& items) {
  if (request.bodies.empty()) return {};
  std::vector<Item> chosen;
  for (const int place : request.bodies) {
    if (static_cast<std::size_t>(place) > items.size()) {
      return about(request.in, "has " + count_text(items.size(), "body", "bodies") + ", and --bodies names " +
                                   std::to_string(place));
    }
    chosen.push_back(items[static_cast<std::size_t>(place) - 1]);
  }
  items = std::move(chosen);
  return {};
}

std::vector<std::string> notes_on_shells(const CadModel& model) {
  std::vector<std::string> notes;
  for (const CadSurface& part : model.surfaces) {
    if (part.shell_thickness_m <= 0.0) continue;
    notes.push_back("'" + part.name + "' is a shell of " + number_text(1e3 * part.shell_thickness_m) +
                    " mm; the surface that it lies behind is written, without the thickness");
  }
  return notes;
}

Status write_model(const CadModel& model, const Job& job, const CadChild& child, ConversionReport& report) {
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
  for (std::string& note : notes_on_shells(model)) report.notes.push_back(std::move(note));
  report.notes.insert(report.notes.end(), content->notes.begin(), content->notes.end());
  return write_file(request.out, content->text);
}

CadChild child_of(const ConversionRequest& request, const Progress& progress) {
  CadChild child;
  child.program = request.cad_program;
  child.progress = progress;
  return child;
}

Status write_mesh_file(const CadModel& model, const Job& job, const Progress& progress,
                       ConversionReport& report) {
  const ConversionRequest& request = job.request;
  const LengthUnit unit = request.unit.value_or(job.out == FileFormat::ply ? metre : millimetre);
  ModelMeshing meshing;
  meshing.chord_m = request.chord_m.value_or(usual_chord_m);
  meshing.file = request.out;
  meshing.child = child_of(request, progress.part(share_of_reading, share_of_solids));
  meshing.progress = progress.part(share_of_solids, 1.0);
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
  auto out = OutputFile::create(request.out);
  if (!out) return out.error();
  // What the file refuses names it, what the writer refuses does not.
  Status taken;
  const Status written = write_meshes(made->meshes, job.out, unit.metres, [&](std::string_view bytes) {
    taken = progress.report(1.0) ? out->write(bytes) : Status(about(request.out, "stopped"));
    return taken;
  });
  if (!taken) return taken;
  return written ? out->commit() : Status(about(request.out, written.error().message));
}

Status write_native(const CadModel& model, const ConversionRequest& request, ConversionReport& report) {
  const auto document = document_of(model, clean_cad_name(request.out.stem().string(), "model"));
  if (!document) return about(request.in, document.error().message);
  report.unit_out = "mm";
  const std::size_t bodies = document->scene.bodies.size();
  if (bodies > static_cast<std::size_t>(sculpted_body_count_range.high)) {
    report.notes.push_back("of the " + std::to_string(bodies) + " bodies at most " +
                           std::to_string(sculpted_body_count_range.high) +
                           " are sculpted together; choose some with --bodies 1,3-5");
  }
  return write_document(document.value(), request.out);
}

// Some of a document's bodies, as they are.
Result<ConversionReport> choose_from_document(const ConversionRequest& request) {
  auto document = read_document(request.in);
  if (!document) return document.error();
  if (Status chosen = choose(request, document->scene.bodies); !chosen) return chosen.error();
  if (Status written = write_document(document.value(), request.out); !written) return written.error();
  ConversionReport report;
  report.unit_in = report.unit_out = millimetre.name;
  report.surfaces = model_of(std::move(document->scene.bodies)).surfaces;
  return report;
}

Result<ConversionReport> written_report(CadModel model, const Job& job, const Progress& progress) {
  const ConversionRequest& request = job.request;
  ConversionReport report;
  report.unit_in = model.unit;
  report.unit_declared = model.unit_declared;
  report.notes.insert(report.notes.end(), model.notes.begin(), model.notes.end());
  if (!progress.report(share_of_reading)) return about(request.out, "stopped");
  const Status written =
      job.out == FileFormat::document ? write_native(model, request, report)
      : is_cad(job.out)
          ? write_model(model, job, child_of(request, progress.part(share_of_reading, 1.0)), report)
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
  if (!is_exported_to(out)) return about(out, "names no format that bodies are exported to");
  return written_report(model_of(std::move(bodies)), {request}, progress);
}

Result<ConversionReport> convert_file(const ConversionRequest& request, const Progress& progress) {
  const Job job{request};
  if (Status formats = check_formats(job); !formats) return formats.error();
  if (Status options = check_options(job); !options) return options.error();
  if (job.in == FileFormat::document && job.out == FileFormat::document) {
    return choose_from_document(request);
  }
  auto model = read_model(job, child_of(request, progress.part(0.0, share_of_reading)));
  if (!model) return model.error();
  if (Status chosen = choose(request, model->surfaces); !chosen) return chosen.error();
  return written_report(std::move(model).value(), job, progress);
}

}  // namespace spoonbill
