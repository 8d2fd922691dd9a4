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
#include "app/commands/common_options.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/parsed_option.h"
#include "app/files/error_cloud.h"
#include "app/files/fitted_document.h"
#include "app/files/scan_file.h"
#include "app/interrupt.h"
#include "app/report/fit_facts.h"
#include "app/report/progress_bar.h"
#include "engine/base/text.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

constexpr Range<int> control_range{4, 200};
constexpr Range<double> tolerance_range_m{1e-6, 0.1};
// Where colours end that no tolerance asks for.
constexpr double least_scale_m = 1e-6;

struct FitOptions {
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
    return Error{"stopped; " + options.out.string() + " was not written"};
  }
  if (!fit) return Error{options.scan.string() + ": " + fit.error().message};
  return fit;
}

// That a document can hold, with the number of a body behind it.
std::string name_of(const std::filesystem::path& scan) {
  return clean_cad_name(scan.stem().string(), "scan", cad_name_bytes_limit - 2);
}

Status fit(const FitOptions& options, Console& console) {
  std::error_code ignored;
  if (std::filesystem::equivalent(options.scan, options.errors, ignored)) {
    return Error{options.errors.string() + ": is the scan itself; choose another name"};
  }
  const auto clay = read_material(std::filesystem::path(assets_folder) / "materials/modelling-clay.json");
  if (!clay) return clay.error();
  MeshReading reading;
  reading.unit = options.unit;
  auto file = read_scan_file(options.scan, reading);
  if (!file) return file.error();
  const auto fitted = fit_with_progress(options, std::move(file->scan), console);
  if (!fitted) return fitted.error();
  const auto document = fitted_document(fitted.value(), name_of(options.scan), clay.value());
  if (!document) return Error{options.scan.string() + ": " + document.error().message};
  // Files become whole: what asks to stop now waits for them.
  const InterruptWatch until_written;
  if (Status written = write_document(document->document, options.out); !written) return written;
  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  add_scan_facts(facts, file.value(), fitted.value());
  const double tolerance_m = options.request.settings.tolerance_m;
  add_fit_facts(facts, fitted.value(), tolerance_m);
  if (!options.errors.empty()) {
    const double full =
        std::max(least_scale_m, tolerance_m > 0.0 ? tolerance_m : deviation_of_all(fitted.value()).p95_m);
    if (Status written = write_error_cloud(fitted.value(), full, options.errors); !written) return written;
    facts.add("Colours", options.errors.string() + ", from 0 to " + short_length_text(full), "errors_file",
              options.errors.string());
    facts.add("", "", "errors_full_m", full);
  }
  std::vector<std::string> remarks = document->remarks;
  for (std::string& remark : shortcoming_remarks(fitted.value(), tolerance_m)) {
    remarks.push_back(std::move(remark));
  }
  if (const auto remark = size_remark(file.value(), fitted.value())) remarks.push_back(*remark);
  if (const auto remark = looseness_remark(fitted.value())) remarks.push_back(*remark);
  add_remarks(facts, remarks);
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
  return Error{"'" + excerpt(text) + "' does not end in .ply, as a cloud with colours does"};
}

void add_options(OptionSet parser, const std::shared_ptr<FitOptions>& options) {
  parser
      .add_option("SCAN", options->scan,
                  "Points (.ply, .pcd, .xyz, .txt, .csv, .asc, .pts, .obj) or triangles (.ply, .obj, .stl)")
      .require();
  add_document_output(parser, options->out).require();
  add_parsed_option(
      parser, "--control", "UxV",
      [](const std::string& text) { return parse_extent(text, control_range, "24x24"); },
      [options](const Extent& control) { options->control = control; },
      "At most so many control points along u and v (24x24 unless told)");
  add_parsed_option(
      parser, "--tolerance", "LENGTH",
      [](const std::string& text) { return parse_length(text, tolerance_range_m); },
      [options](double length) { options->request.settings.tolerance_m = length; },
      "No more control points once the scan lies within; it is said where 95 % of it does not");
  add_parsed_option(
      parser, "--unit", "UNIT", [](const std::string& text) { return parse_unit(text); },
      [options](const LengthUnit& unit) { options->unit = unit; },
      "The unit of the scan's numbers: mm, cm, m or in (PLY and PCD: m, others: mm)");
  add_parsed_option(
      parser, "--kind", "KIND", parse_kind, [options](ShapeKind kind) { options->request.kind = kind; },
      "sheet, tube or closed; found unless told");
  add_parsed_option(
      parser, "--islands", "CHOICE", parse_islands,
      [options](IslandChoice islands) { options->request.islands = islands; },
      "Of a scan in several parts: largest alone (unless told), bridge for one closed body over the gaps, or "
      "all, each a body");
  add_parsed_option(
      parser, "--errors", "FILE", parse_cloud_name,
      [options](const std::filesystem::path& file) { options->errors = file; },
      "A cloud of the scan's points coloured by their distance (.ply)");
  add_json_option(parser, options->json);
}

}  // namespace

CommandEntry add_fit(OptionSet root) {
  auto options = std::make_shared<FitOptions>();
  const OptionSet parser = root.add_command("fit", "Fit B-spline surfaces to a scan");
  parser.set_footer(
      "Outliers and specks are left out, and the kind of shape is found: a sheet (open both ways), a tube\n"
      "(closes in u), or a closed shape (closes in u, with a pole at both ends of v). Knots go where errors\n"
      "are. The report tells how far scan and surface are from each other, both ways, and whether the "
      "surface\n"
      "folds. Closed shapes become solids of clay, others shells.\n"
      "Example: spoonbill fit pear.ply --out pear.json --control 24x24 --errors pear-errors.ply");
  add_options(parser, options);
  return {parser, [options](Console& console) { return fit(*options, console); }};
}

}  // namespace spoonbill
