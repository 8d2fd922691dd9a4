#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/assets_folder.h"
#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/files/scan_file.h"
#include "app/report/fit_report.h"
#include "engine/base/text.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

constexpr Range<int> fit_control_range{4, 200};
constexpr Range<double> fit_tolerance_range_m{1e-6, 0.1};
// Lower limit on the distance at the end of the error cloud's colour scale, which begins at 0.
constexpr double least_scale_m = 1e-6;

struct FitOptions {
  OutputOptions how;
  std::filesystem::path scan, out, errors;
  Extent control{24, 24};
  std::optional<LengthUnit> unit;
  FitRequest request;
  bool json = false;
};

Result<ScanFit> fit_with_progress(const FitOptions& options, Scan scan, Console& console) {
  InterruptWatch interrupt;
  ProgressBar bar(console, "Fitting", false);
  bool stopped = false;
  FitRequest request = options.request;
  request.settings.control_u = options.control.width;
  request.settings.control_v = options.control.height;
  request.settings.progress = Progress([&](double fraction) {
    bar.show(fraction);
    stopped = interrupt.requested();
    return !stopped;
  });
  auto fit = fit_scan(std::move(scan), request);
  if (stopped) {
    interrupt.answer();
    return stopped_before_writing(options.out);
  }
  if (!fit) return fit.error().in(options.scan.string());
  return fit;
}

// Returns the name of the scan's file without the extension, shortened so that the number of a body can be
// appended.
std::string document_name(const std::filesystem::path& scan) {
  return clean_cad_name(scan.stem().string(), "scan", cad_name_bytes_limit - 2);
}

Status fit(const FitOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  if (Status checked = check_output(options.errors, options.how); !checked) return checked;
  if (Status checked = check_is_not_source(options.errors, options.scan, "--errors"); !checked)
    return checked;
  const auto clay = read_material(std::filesystem::path(assets_folder) / "materials/modelling-clay.json");
  if (!clay) return clay.error();
  MeshReading reading;
  reading.unit = options.unit;
  auto file = read_scan_file(options.scan, reading);
  if (!file) return file.error();
  const auto fitted = fit_with_progress(options, std::move(file->scan), console);
  if (!fitted) return fitted.error();
  const auto document = make_fitted_document(fitted.value(), document_name(options.scan), clay.value());
  if (!document) return document.error().in(options.scan.string());
  // Ctrl+C takes effect only when the files are complete.
  const InterruptWatch until_written;
  if (Status written = write_document(document->document, options.out, options.how); !written) return written;
  FactSheet facts;
  add_left_out_facts(facts, file.value(), fitted.value());
  facts.add("File", options.out.string(), "file", options.out.string());
  add_scan_facts(facts, file.value(), fitted.value());
  const double tolerance_m = options.request.settings.tolerance_m;
  add_fit_facts(facts, fitted.value(), tolerance_m);
  if (!options.errors.empty()) {
    const double full =
        std::max(least_scale_m, tolerance_m > 0.0 ? tolerance_m : deviation_of_all(fitted.value()).p95_m);
    if (Status written = write_error_cloud(fitted.value(), full, options.errors, options.how); !written)
      return written;
    facts.add("Colours", options.errors.string() + ", from 0 to " + short_length_text(full), "errors_file",
              options.errors.string());
    facts.add("", "", "errors_full_m", full);
  }
  std::vector<std::string> notes = document->notes;
  for (std::string& note : find_fit_shortcomings(fitted.value(), tolerance_m)) {
    notes.push_back(std::move(note));
  }
  if (const auto note = find_size_note(file.value(), fitted.value())) notes.push_back(*note);
  if (const auto note = find_detail_note(fitted.value())) notes.push_back(*note);
  add_notes(facts, notes);
  facts.print(console.out, options.json);
  return {};
}

Result<ShapeKind> parse_kind(const std::string& text) {
  return parse_choice<ShapeKind>(
      text, {{"sheet", ShapeKind::sheet}, {"tube", ShapeKind::tube}, {"closed", ShapeKind::closed}});
}

Result<IslandChoice> parse_islands(const std::string& text) {
  return parse_choice<IslandChoice>(
      text,
      {{"largest", IslandChoice::largest}, {"bridge", IslandChoice::bridge}, {"all", IslandChoice::all}});
}

Result<std::filesystem::path> parse_cloud_name(const std::string& text) {
  if (format_from_name(text) == FileFormat::ply) return std::filesystem::path(text);
  return Error{ErrorCode::unsupported,
               "'" + excerpt(text) + "' does not end in .ply; the coloured cloud is a PLY file"};
}

void add_options(OptionSet parser, const std::shared_ptr<FitOptions>& options) {
  parser
      .add_option("SCAN", options->scan,
                  "Point cloud (.ply, .pcd, .xyz, .txt, .csv, .asc, .pts, .obj) or mesh (.ply, .obj, .stl)")
      .require();
  add_force_option(parser, options->how);
  add_document_output(parser, options->out).require();
  add_parsed_option(
      parser, "--control", "UxV",
      [](const std::string& text) { return parse_extent(text, fit_control_range, "24x24"); },
      [options](const Extent& control) { options->control = control; },
      "Largest number of control points along u and v, each from 4 to 200; default: 24x24");
  add_parsed_option(
      parser, "--tolerance", "LENGTH",
      [](const std::string& text) { return parse_length(text, fit_tolerance_range_m); },
      [options](double length) { options->request.settings.tolerance_m = length; },
      "Tolerance of the fit: control points are added only where the scan is farther than this from the "
      "surface; a note reports if less than 95 % of the scan is within the tolerance. Default: none; "
      "range: " +
          short_length_text(fit_tolerance_range_m.low) + " to " +
          short_length_text(fit_tolerance_range_m.high));
  add_parsed_option(
      parser, "--unit", "UNIT", [](const std::string& text) { return parse_unit(text); },
      [options](const LengthUnit& unit) { options->unit = unit; },
      "Unit of the scan's numbers: mm, cm, m or in; default: m for .ply and .pcd, mm for others");
  add_parsed_option(
      parser, "--kind", "KIND", parse_kind, [options](ShapeKind kind) { options->request.kind = kind; },
      "Kind of shape: sheet, tube or closed; default: detected");
  add_parsed_option(
      parser, "--islands", "CHOICE", parse_islands,
      [options](IslandChoice islands) { options->request.islands = islands; },
      "Parts of the scan to fit: 'largest' (default), 'bridge' (one closed body across the gaps) or 'all' "
      "(one "
      "body for each part)");
  add_parsed_option(
      parser, "--errors", "FILE", parse_cloud_name,
      [options](const std::filesystem::path& file) { options->errors = file; },
      "Point cloud to write (.ply): the scan's points, coloured by their distance from the surface");
  add_json_option(parser, options->json);
}

}  // namespace

CommandEntry add_fit(OptionSet root) {
  auto options = std::make_shared<FitOptions>();
  const OptionSet parser = root.add_command("fit", "Fit B-spline surfaces to a scan");
  parser.set_footer(
      "Outliers and specks are ignored, and the kind of shape is detected: a sheet (open in both\n"
      "directions), a tube (closed in u) or a closed shape (closed in u, a pole at both ends of v). Knots\n"
      "are added where errors are large. The report gives the distances from scan to surface and back, and\n"
      "whether the surface folds. Closed shapes become solids of clay, others become shells.\n"
      "Example: spoonbill fit assets/models/egg.stl --out egg.json --errors egg-errors.ply");
  add_options(parser, options);
  return {parser, [options](Console& console) { return fit(*options, console); }};
}

}  // namespace spoonbill
