#include <memory>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/conversion.h"
#include "app/report/document_facts.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

constexpr Range<double> cad_tolerance_range_m{1e-9, 0.01};
constexpr Range<double> sew_range_m{1e-9, 1e-4};

struct ConvertOptions {
  ConversionRequest request;
  bool progress = false;
  bool json = false;
};

void add_conversion_facts(FactSheet& facts, const ConversionReport& report) {
  add_unit_facts(facts, report.unit_in, report.unit_declared);
  facts.add("Unit written", report.unit_out, "unit_out", report.unit_out);
  add_surface_facts(facts, report.surfaces);
  if (report.solids) {
    facts.add("Solids", std::to_string(*report.solids), "solids", *report.solids);
    facts.add("Not solid", std::to_string(*report.open_shells), "open_shells", *report.open_shells);
  }
  if (report.triangles) {
    facts.add("Triangles",
              std::to_string(*report.triangles) + ", within " +
                  millimetres_with_digits(report.chord_error_m, 2) + " of the surface",
              "triangles", *report.triangles);
    facts.add("Watertight",
              std::to_string(*report.closed_meshes) + " of " + std::to_string(report.meshes.value_or(0)),
              "closed_meshes", *report.closed_meshes);
    facts.add("", "", "meshes", report.meshes.value_or(0));
    facts.add("", "", "chord_error_m", report.chord_error_m);
  }
  for (const std::string& note : report.notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", report.notes);
}

Status convert_model(const ConvertOptions& options, Console& console) {
  if (Status checked = check_output(options.request.out, options.request.how); !checked) return checked;
  InterruptWatch interrupt;
  Result<ConversionReport> report = Error{ErrorCode::internal, "not converted"};
  {
    ProgressBar bar(console, "Converting", options.progress);
    report = convert_file(options.request, Progress([&](double fraction) {
                            bar.show(fraction);
                            return !interrupt.requested();
                          }));
  }
  if (interrupt.requested()) interrupt.answer();
  if (!report) return report.error();
  FactSheet facts;
  facts.add("From", options.request.in.string(), "in", options.request.in.string());
  facts.add("To", options.request.out.string(), "out", options.request.out.string());
  add_conversion_facts(facts, report.value());
  facts.print(console.out, options.json);
  return {};
}

Result<StepSchema> parse_schema(const std::string& text) {
  if (text == "ap214") return StepSchema::ap214;
  if (text == "ap242") return StepSchema::ap242;
  return Error{ErrorCode::unknown,
               "'" + excerpt(text) + "' is not a supported STEP schema; choose ap214 or ap242"};
}

}  // namespace

CommandEntry add_convert(OptionSet root) {
  auto options = std::make_shared<ConvertOptions>();
  const OptionSet parser = root.add_command("convert", "Convert a model from or to CAD, or to a mesh");
  parser.set_footer(
      "Reads documents (.json), STEP (.step, .stp) and IGES (.iges, .igs); writes the same formats and\n"
      "meshes (.stl, .obj, .ply, .3mf). Closed bodies become solids in STEP and IGES, and watertight\n"
      "meshes. Each face of a CAD file becomes a body. Loose faces whose edges meet are joined to a\n"
      "solid. Faces of one solid are written as that solid if they close, in CAD files and in meshes;\n"
      "bridged gaps are reported, and a body that cannot be written is left out with a note. OUT appears\n"
      "complete or not at all.\n"
      "Example: spoonbill convert assets/models/spoon-handle.json handle.step --schema ap242");
  parser.add_option("IN", options->request.in, "Document or CAD file to read").require();
  parser.add_option("OUT", options->request.out, "File to write; its ending selects the format").require();
  ConversionRequest& request = options->request;
  const auto length_in = [](Range<double> range) {
    return [range](const std::string& text) { return parse_length(text, range); };
  };
  add_parsed_option(
      parser, "--unit", "UNIT", parse_unit, [&request](const LengthUnit& unit) { request.unit = unit; },
      "Unit of the CAD or mesh file's numbers: mm, cm, m or in. Default when writing: mm, or m for .ply; "
      "default when reading: the unit that the file declares, or mm");
  add_parsed_option(
      parser, "--chord", "LENGTH", length_in(chord_range_m),
      [&request](double chord_m) { request.chord_m = chord_m; },
      "Largest distance of a mesh's triangles from the surface; default: 0.05mm, range: " +
          short_length_text(chord_range_m.low) + " to " + short_length_text(chord_range_m.high));
  parser.add_flag("--allow-deviation", request.allow_deviation,
                  "Write meshes also if they are farther away from the surface than --chord");
  add_parsed_option(
      parser, "--tolerance", "LENGTH", length_in(cad_tolerance_range_m),
      [&request](double tolerance_m) { request.tolerance_m = tolerance_m; },
      "Largest deviation of CAD geometry that is not a B-spline, such as a cylinder; default: 0.01mm, "
      "range: " +
          short_length_text(cad_tolerance_range_m.low) + " to " +
          short_length_text(cad_tolerance_range_m.high));
  add_parsed_option(
      parser, "--sew", "LENGTH", length_in(sew_range_m), [&request](double sew_m) { request.sew_m = sew_m; },
      "Largest gap between loose faces of a CAD file that are joined to a solid; default: the file's "
      "tolerance, range: " +
          short_length_text(sew_range_m.low) + " to " + short_length_text(sew_range_m.high));
  add_parsed_option(
      parser, "--schema", "SCHEMA", parse_schema, [&request](StepSchema schema) { request.schema = schema; },
      "Schema of a STEP file: ap214 (default) or ap242");
  add_parsed_option(
      parser, "--bodies", "LIST", parse_number_list,
      [&request](const std::vector<int>& numbers) { request.bodies = numbers; },
      "Numbers of the bodies to convert, as `spoonbill info` lists them, such as 1,3-5; default: all");
  parser.add_flag("--progress", options->progress, "Show progress even if the output is not a terminal");
  add_force_option(parser, request.how);
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return convert_model(*options, console); }};
}

}  // namespace spoonbill
