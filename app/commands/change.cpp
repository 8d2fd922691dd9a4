#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/left_out.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/parsed_option.h"
#include "app/commands/surface_change.h"
#include "app/commands/watched_work.h"
#include "app/files/document_file.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {
namespace {

constexpr Range<double> tolerance_range_m{1e-9, 0.1};

struct ChangeOptions {
  std::filesystem::path model, out;
  AskedChange change;
  std::optional<int> continuity;  // where it is asked for
  int body = 1;
  double tolerance_m = 1e-5;
  bool json = false;
};

void replace_body(std::vector<Body>& bodies, std::size_t place, ChangedSurfaces changed,
                  std::vector<std::string>& remarks) {
  Body body = bodies[place];
  if (!changed.keeps_parameters) leave_out_shares(body, remarks);
  bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(place));
  for (std::size_t k = 0; k < changed.surfaces.size(); ++k) {
    Body part = body;
    if (changed.surfaces.size() > 1) {
      part.name = clean_cad_name(body.name, "part", cad_name_bytes_limit - 2) + " " + std::to_string(k + 1);
    }
    part.surface = std::move(changed.surfaces[k]);
    part.trims = changed.trims;
    settle_thickness(part, body.surface, remarks);
    bodies.insert(bodies.begin() + static_cast<std::ptrdiff_t>(place + k), std::move(part));
  }
}

void report(const ChangeOptions& options, const std::vector<Body>& bodies, double deviation_m,
            const std::vector<std::string>& remarks, Console& console) {
  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  facts.add("Deviation", deviation_text(deviation_m), "deviation_m", deviation_m);
  Json list = Json::array();
  for (const Body& body : bodies) {
    const KnotVector &u = body.surface.u, &v = body.surface.v;
    const std::string counts =
        std::to_string(u.control_point_count()) + " x " + std::to_string(v.control_point_count());
    facts.add("Body",
              body.name + ": " + counts + " control points, degrees " + std::to_string(u.degree()) + " and " +
                  std::to_string(v.degree()),
              "", nullptr);
    list.push_back({{"name", body.name},
                    {"control_points", {u.control_point_count(), v.control_point_count()}},
                    {"degrees", {u.degree(), v.degree()}},
                    {"periodic", {u.is_periodic(), v.is_periodic()}}});
  }
  facts.add("", "", "bodies", list);
  add_remarks(facts, remarks);
  facts.print(console.out, options.json);
}

Status change(const ChangeOptions& options, Console& console) {
  AskedChange asked = options.change;
  if (options.continuity) asked.continuity = *options.continuity;
  auto document = read_document_file(options.model);
  if (!document) return document.error();
  std::vector<Body>& bodies = document->scene.bodies;
  if (options.body > static_cast<int>(bodies.size())) {
    return Error{options.model.string() + ": has " + count_text(bodies.size(), "body", "bodies") +
                 ", and --body names " + std::to_string(options.body)};
  }
  const std::size_t place = static_cast<std::size_t>(options.body) - 1;
  auto result = WatchedWork(console, "Changing", options.out)
                    .done([&](const Progress& progress) -> Result<ChangedSurfaces> {
                      auto made = changed(bodies[place].surface, bodies[place].trims, asked,
                                          options.tolerance_m, progress);
                      if (made) return made;
                      return Error{options.model.string() + ": body \"" + bodies[place].name +
                                   "\": " + made.error().message};
                    });
  if (!result) return result.error();
  const double deviation_m = result->deviation_m;
  std::vector<std::string> remarks;
  replace_body(bodies, place, std::move(result).value(), remarks);
  // A file becomes whole: what asks to stop now waits for it.
  const InterruptWatch until_written;
  if (Status written = write_document(document.value(), options.out); !written) return written;
  report(options, bodies, deviation_m, remarks, console);
  return {};
}

}  // namespace

CommandEntry add_change(OptionSet root) {
  auto options = std::make_shared<ChangeOptions>();
  const OptionSet parser = root.add_command("change", "Split, close, reverse or refine a body's surface");
  parser.set_footer(
      "Changes:\n" + changes_text() +
      "Places are parameters in the knots' domain, as `spoonbill info` tells it. Regions, loads and\n"
      "supports stay where the change keeps the parameters, and are left out where it does not.\n"
      "Example: spoonbill change assets/models/spoon-handle.json split v=50 --out halves.json");
  parser.add_option("MODEL", options->model, "A document (.json)").require();
  parser
      .add_parsed_list(
          "CHANGE",
          [options](const std::vector<std::string>& words) -> Status {
            const auto change = parse_change(words);
            if (!change) return change.error();
            options->change = change.value();
            return {};
          },
          "What to do, as below")
      .require();
  add_document_output(parser, options->out, "The changed document (.json)").require();
  parser.add_option("--body", options->body, "Which body, counted from 1; the first unless told")
      .limit(body_count_range)
      .show_as("NUMBER");
  add_parsed_option(
      parser, "--tolerance", "LENGTH",
      [](const std::string& text) { return parse_length(text, tolerance_range_m); },
      [options](double length_m) { options->tolerance_m = length_m; },
      "For changes that are not exact, " + short_length_text(options->tolerance_m) + " unless told");
  add_parsed_option(
      parser, "--continuity", "C0..C8", parse_continuity,
      [options](int order) { options->continuity = order; },
      "Of the seam that close makes, C2 unless told; C0 keeps an edge");
  // By then both have been read, in whichever order they came.
  parser.set_final_check([options]() -> Status {
    if (options->continuity && options->change.kind != ChangeKind::close) {
      return Error{"--continuity: is of the seam that 'close' makes; leave it out"};
    }
    return {};
  });
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return change(*options, console); }};
}

}  // namespace spoonbill
