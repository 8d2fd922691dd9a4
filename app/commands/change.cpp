#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/placing.h"
#include "app/commands/surface_change.h"
#include "app/files/documents.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {
namespace {

constexpr Range<double> change_tolerance_range_m{1e-9, 0.1};

struct ChangeOptions {
  OutputOptions how;
  std::filesystem::path model, out;
  std::variant<ChangeRequest, PlacingRequest> change;
  std::optional<Vector3> about_m;  // fixed point of a placing; empty if --about is not given
  std::optional<int> continuity;   // empty if --continuity is not given
  std::optional<Extent> control;   // empty if --control is not given
  int body = 1;
  double tolerance_m = 1e-5;
  bool json = false;
};

void replace_body(std::vector<Body>& bodies, std::size_t index, ChangedSurfaces changed,
                  std::vector<std::string>& notes) {
  Body body = bodies[index];
  if (!changed.keeps_parameters) drop_surface_features(body, notes);
  bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(index));
  for (std::size_t k = 0; k < changed.surfaces.size(); ++k) {
    Body part = body;
    if (changed.surfaces.size() > 1) {
      part.name = clean_cad_name(body.name, "part", cad_name_bytes_limit - 2) + " " + std::to_string(k + 1);
    }
    part.surface = std::move(changed.surfaces[k]);
    part.trims = changed.trims;
    adapt_thickness(part, body.surface, notes);
    bodies.insert(bodies.begin() + static_cast<std::ptrdiff_t>(index + k), std::move(part));
  }
}

template <class Parsed>
Status store_parsed(Result<Parsed> parsed, std::variant<ChangeRequest, PlacingRequest>& change) {
  if (!parsed) return parsed.error();
  change = std::move(parsed).value();
  return {};
}

void report_change(const ChangeOptions& options, const std::vector<Body>& bodies, double deviation_m,
                   const std::vector<std::string>& notes, Console& console) {
  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  facts.add("Deviation", deviation_text(deviation_m), "deviation_m", deviation_m);
  Json list = Json::array();
  for (const Body& body : bodies) {
    if (body.mesh) continue;
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
  add_notes(facts, notes);
  facts.print(console.out, options.json);
}

// Changes the surface of a body. Returns the largest deviation.
Result<double> change_body_surface(const ChangeOptions& options, ChangeRequest request, std::size_t index,
                                   std::vector<Body>& bodies, std::vector<std::string>& notes,
                                   Console& console) {
  if (options.continuity) request.continuity = *options.continuity;
  if (options.control) request.control = {options.control->width, options.control->height};
  const Body& body = bodies[index];
  if (Status surface = check_surfaces({body}, options.model); !surface) return surface.error();
  auto result = CancellableJob(console, "Changing", options.out)
                    .run([&](const Progress& progress) -> Result<ChangedSurfaces> {
                      auto changed =
                          change_surface(body.surface, body.trims, request, options.tolerance_m, progress);
                      if (changed) return changed;
                      return changed.error().in("body \"" + body.name + "\"").in(options.model.string());
                    });
  if (!result) return result.error();
  const double deviation_m = result->deviation_m;
  replace_body(bodies, index, std::move(result).value(), notes);
  return deviation_m;
}

Status change(const ChangeOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  auto document = read_document_file(options.model);
  if (!document) return document.error();
  std::vector<Body>& bodies = document->scene.bodies;
  if (options.body > static_cast<int>(bodies.size())) {
    return Error{ErrorCode::out_of_range,
                 options.model.string() + ": has " + count_text(bodies.size(), "body", "bodies") +
                     ", and --body names " + std::to_string(options.body),
                 "--body"};
  }
  const std::size_t index = static_cast<std::size_t>(options.body) - 1;
  std::vector<std::string> notes;
  double deviation_m = 0.0;
  if (const auto* const placing = std::get_if<PlacingRequest>(&options.change)) {
    if (Status placed = place_body(*placing, options.about_m, index, document->scene, notes); !placed) {
      return placed.error().in("body \"" + bodies[index].name + "\"").in(options.model.string());
    }
  } else {
    const auto changed =
        change_body_surface(options, std::get<ChangeRequest>(options.change), index, bodies, notes, console);
    if (!changed) return changed.error();
    deviation_m = changed.value();
  }
  if (const std::string note = drop_unfit_trial(document->scene); !note.empty()) notes.push_back(note);
  // Ctrl+C takes effect only when the file is complete.
  const InterruptWatch until_written;
  if (Status written = write_document(document.value(), options.out, options.how); !written) return written;
  report_change(options, bodies, deviation_m, notes, console);
  return {};
}

}  // namespace

CommandEntry add_change(OptionSet root) {
  auto options = std::make_shared<ChangeOptions>();
  const OptionSet parser =
      root.add_command("change", "Place a body, or split, close, reverse or refine its surface");
  parser.set_footer(
      "Changes of the place:\n" + list_placings() + "Changes of the surface:\n" + list_changes() +
      "A parameter is in the knot domain, which `spoonbill info` shows. Regions, loads, supports and\n"
      "the rim are kept by insert, remove, degree, simplify, rebuild and close, by all changes of the\n"
      "place, and dropped by the other changes of the surface.\n"
      "Example: spoonbill change assets/models/spoon-handle.json split v=50 --out halves.json");
  parser.add_option("MODEL", options->model, "Document (.json)").require();
  parser
      .add_parsed_list(
          "CHANGE",
          [options](const std::vector<std::string>& words) -> Status {
            if (is_placing(words)) return store_parsed(parse_placing(words), options->change);
            return store_parsed(parse_change(words), options->change);
          },
          "Change and its arguments, as listed below")
      .require();
  add_force_option(parser, options->how);
  add_document_output(parser, options->out, "Document to write (.json)").require();
  parser.add_option("--body", options->body, "Number of the body, from 1; default: 1")
      .limit(body_count_range)
      .show_as("NUMBER");
  add_parsed_option(
      parser, "--tolerance", "LENGTH",
      [](const std::string& text) { return parse_length(text, change_tolerance_range_m); },
      [options](double length_m) { options->tolerance_m = length_m; },
      "Largest deviation of a change that is not exact; default: " + short_length_text(options->tolerance_m) +
          ", range: " + short_length_text(change_tolerance_range_m.low) + " to " +
          short_length_text(change_tolerance_range_m.high));
  add_parsed_option(
      parser, "--continuity", "C0..C8", parse_continuity,
      [options](int order) { options->continuity = order; },
      "Continuity of the seam that `close` makes; default: C2. C0 keeps an edge");
  add_parsed_option(
      parser, "--control", "UxV",
      [](const std::string& text) { return parse_extent(text, control_point_count_range, "20x20"); },
      [options](const Extent& control) { options->control = control; },
      "Control points along u and v that `rebuild` leaves, such as 20x20");
  add_parsed_option(
      parser, "--about", "X,Y,Z", [](const std::string& text) { return parse_position(text); },
      [options](const Vector3& about_m) { options->about_m = about_m; },
      "Point that rotate, scale, mirror and align length keep, such as 10mm,0,0; default: the body's centre");
  // CHANGE and --continuity may be given in any order, so the check runs after both are parsed.
  parser.set_final_check([options]() -> Status {
    const auto* const surface_change = std::get_if<ChangeRequest>(&options->change);
    const auto is_kind = [&](ChangeKind kind) { return surface_change && surface_change->kind == kind; };
    if (options->continuity && !is_kind(ChangeKind::close)) {
      return Error{ErrorCode::inconsistent,
                   "--continuity: applies only to the seam that 'close' makes; remove --continuity",
                   "--continuity"};
    }
    const bool rebuilds = is_kind(ChangeKind::rebuild);
    if (rebuilds != options->control.has_value()) {
      return Error{ErrorCode::inconsistent,
                   rebuilds ? "rebuild: needs --control, such as --control 20x20"
                            : "--control: applies only to 'rebuild'; remove --control",
                   "--control"};
    }
    const auto* const placing = std::get_if<PlacingRequest>(&options->change);
    if (options->about_m && !(placing && takes_point(placing->kind))) {
      return Error{ErrorCode::inconsistent,
                   "--about: applies only to rotate, scale, mirror and align length; remove --about",
                   "--about"};
    }
    return {};
  });
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return change(*options, console); }};
}

}  // namespace spoonbill
