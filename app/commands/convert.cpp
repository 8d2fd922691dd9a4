#include <memory>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/parsed_option.h"
#include "app/convert/conversion.h"
#include "app/interrupt.h"
#include "app/report/conversion_facts.h"
#include "app/report/progress_bar.h"
#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

constexpr Range<double> tolerance_range_m{1e-9, 0.01};

struct ConvertOptions {
  ConversionRequest request;
  bool progress = false;
  bool json = false;
};

Status convert(const ConvertOptions& options, Console& console) {
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
  return Error{"'" + text.substr(0, 40) + "' is not a schema of STEP: ap214 or ap242"};
}

}  // namespace

CommandEntry add_convert(OptionSet root) {
  auto options = std::make_shared<ConvertOptions>();
  const OptionSet parser =
      root.add_command("convert", "Bring a model in from CAD, or out to CAD or as a mesh");
  parser.set_footer(
      "Read: documents (.json), STEP (.step, .stp) and IGES (.iges, .igs). Written: those, and meshes "
      "(.stl,\n"
      ".obj, .ply, .3mf). Bodies that close become solids in STEP and IGES, and watertight meshes; each "
      "face\n"
      "of a CAD file becomes a body, those of one solid too, which leave as that solid again where they\n"
      "close, in a mesh as well; gaps of theirs that are bridged are said. OUT appears whole or not at all.\n"
      "Example: spoonbill convert assets/models/spoon-handle.json handle.step --schema ap242");
  parser.add_option("IN", options->request.in, "A document or a CAD file").require();
  parser.add_option("OUT", options->request.out, "The file to write; its ending is its format").require();
  ConversionRequest& request = options->request;
  const auto length_in = [](Range<double> range) {
    return [range](const std::string& text) { return parse_length(text, range); };
  };
  add_parsed_option(
      parser, "--unit", "UNIT", parse_unit, [&request](const LengthUnit& unit) { request.unit = unit; },
      "Of the other file's numbers: mm, cm, m or in. Going out, mm unless told (m for .ply); coming in,\n"
      "what the file declares unless told, or mm where it declares none");
  add_parsed_option(
      parser, "--chord", "LENGTH", length_in(chord_range_m),
      [&request](double chord_m) { request.chord_m = chord_m; },
      "How far a mesh's triangles may be from the surface; 0.05mm unless told");
  add_parsed_option(
      parser, "--tolerance", "LENGTH", length_in(tolerance_range_m),
      [&request](double tolerance_m) { request.tolerance_m = tolerance_m; },
      "How far what no B-spline is, such as a cylinder, may come to be from itself; 0.01mm unless told");
  add_parsed_option(
      parser, "--schema", "SCHEMA", parse_schema, [&request](StepSchema schema) { request.schema = schema; },
      "Of a STEP file: ap214, unless told, or ap242");
  add_parsed_option(
      parser, "--bodies", "LIST", parse_places,
      [&request](const std::vector<int>& places) { request.bodies = places; },
      "Which of IN's, as `spoonbill info` counts them: 1,3-5; all unless told");
  parser.add_flag("--progress", options->progress, "Show progress even where nobody watches");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return convert(*options, console); }};
}

}  // namespace spoonbill
