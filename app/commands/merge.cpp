#include "engine/merging/merge.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/left_out.h"
#include "app/commands/merge_report.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/parsed_option.h"
#include "app/commands/watched_work.h"
#include "app/files/document_file.h"
#include "app/interrupt.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/inspection/surface_check.h"
#include "engine/inspection/mass_properties.h"
#include "engine/merging/intersection_merge.h"
#include "engine/merging/trimmed_patch.h"

namespace spoonbill {
namespace {

constexpr Range<double> tolerance_range_m{1e-9, 0.1};
constexpr Range<double> blend_range_m{0.0, 1.0};
constexpr Range<double> fillet_range_m{0.0, 1.0};
constexpr Range<double> twist_range{-1.0, 1.0};
// Of the tolerance, for making a trimmed patch whole.
constexpr double trimmed_share = 0.25;
constexpr Range<int> model_count_range{1, 64};

struct MergeOptions {
  std::vector<std::filesystem::path> models;
  std::filesystem::path out;
  std::string name;
  MergeRequest request;
  std::optional<int> continuity;  // where it is asked for
  bool crossing = false;
  double fillet_m = 0.0;
  bool json = false;
};

// "-0.25"
Result<double> parse_twist(const std::string& text) {
  double share = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), share);
  if (error == std::errc() && end == text.data() + text.size() && twist_range.contains(share)) return share;
  return Error{"'" + excerpt(text) + "' is not a share of a turn from -1 to 1"};
}

// "2.v_start": the second patch's edge.
Result<PatchEdge> parse_edge(const std::string& text) {
  const std::size_t dot = text.find('.');
  if (dot == 0 || dot == std::string::npos || dot > 3 || text.find_first_not_of("0123456789") != dot) {
    return Error{"'" + excerpt(text) + "' is not an edge like 2.v_start, the second patch's"};
  }
  const auto side = parse_side(text.substr(dot + 1));
  if (!side) return side.error();
  return PatchEdge{std::stoi(text.substr(0, dot)) - 1, side.value()};
}

// "1.v_end:2.v_start", or with -2.v_start against it.
Result<ChosenEdges> parse_edges(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    return Error{"'" + excerpt(text) + "' is not a pair of edges like 1.v_end:2.v_start"};
  }
  std::string second = text.substr(colon + 1);
  ChosenEdges edges;
  if (!second.empty() && (second[0] == '-' || second[0] == '+')) {
    edges.reversed = second[0] == '-';
    second.erase(0, 1);
  }
  const auto a = parse_edge(text.substr(0, colon)), b = parse_edge(second);
  if (!a) return a.error();
  if (!b) return b.error();
  if (a->patch == b->patch) {
    return Error{"'" + excerpt(text) + "' joins a patch to itself; name two patches"};
  }
  edges.a = a.value();
  edges.b = b.value();
  return edges;
}

// What is to be merged, and what the merged document takes from the first model.
struct Parts {
  std::optional<Document> first;
  std::vector<Body> bodies;
  std::vector<Surface> patches;  // of the bodies, whole
  double untrimmed_m = 0.0;      // how far making them whole moved them
  std::vector<std::string> remarks;
};

struct Outcome {
  Merged merged;
  std::vector<Joint> corners;              // of each body but the first with what those before it became
  std::vector<std::string> tight_fillets;  // remarks
  std::vector<std::size_t> turned;         // the bodies whose normals pointed inwards
};

// C1 for a fillet: an arc and what it touches cannot be C2 without making it tighter.
int continuity_of(const MergeOptions& options) {
  if (options.crossing && options.fillet_m == 0.0) return 0;
  if (options.continuity) return *options.continuity;
  return options.crossing ? 1 : JoinRequest().continuity;
}

void add_remarks_of_merging(const MergeOptions& options, const Outcome& outcome,
                            std::vector<std::string>& remarks) {
  if (options.request.join.blend_m > 0.0) add_unused_blends(outcome.merged.joints, remarks);
  add_left_open(outcome.merged.left_open, remarks);
  const Surface& surface = outcome.merged.surface;
  if (find_closing(surface).closedness == Closedness::solid && compute_enclosed_mass(surface).volume_m3 < 0.0) {
    remarks.emplace_back("its normals point inwards; reverse u with change");
  }
  for (const std::size_t place : outcome.turned) {
    remarks.push_back("the normals of patch " + std::to_string(place + 1) +
                      " pointed inwards; it was turned around first");
  }
  remarks.insert(remarks.end(), outcome.tight_fillets.begin(), outcome.tight_fillets.end());
}

void report(const MergeOptions& options, const Parts& parts, const Outcome& outcome, Console& console) {
  const Merged& merged = outcome.merged;
  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  Json names = Json::array();
  for (const Body& patch : parts.bodies) names.push_back(patch.name);
  facts.add("Patches", std::to_string(parts.bodies.size()), "patches", names);
  const KnotVector &u = merged.surface.u, &v = merged.surface.v;
  facts.add("Control points",
            std::to_string(u.control_point_count()) + " x " + std::to_string(v.control_point_count()) +
                ", degrees " + std::to_string(u.degree()) + " and " + std::to_string(v.degree()),
            "control_points", {u.control_point_count(), v.control_point_count()});
  facts.add("", "", "degrees", {u.degree(), v.degree()});
  const int continuity = continuity_of(options);
  facts.add("Continuity", "C" + std::to_string(continuity), "continuity", continuity);
  facts.add("Deviation", deviation_text(merged.deviation_m) + " outside blends", "deviation_m",
            merged.deviation_m);
  if (options.crossing) {
    add_corners(facts, outcome.corners);
  } else {
    add_joints(facts, merged.joints);
  }
  add_remarks(facts, parts.remarks);
  facts.print(console.out, options.json);
}

Document merged_document(const Document& first, const std::vector<Body>& patches, const MergeOptions& options,
                         Surface surface, std::vector<std::string>& remarks) {
  Document document = first;
  document.name = options.name.empty() ? options.out.stem().string() : options.name;
  Body body = patches[0];
  body.surface = std::move(surface);
  body.trims.clear();
  const bool one_solid = std::all_of(patches.begin(), patches.end(),
                                     [&](const Body& patch) { return patch.solid == body.solid; });
  if (!one_solid || find_closing(body.surface).closedness == Closedness::solid) body.solid.clear();
  if (patches.size() > 1) {
    body.name = document.name;
    document.view = Json::object();  // so that the whole of it is framed
  }
  settle_thickness(body, patches[0].surface, remarks);
  document.scene.bodies = {std::move(body)};
  return document;
}

Result<Parts> read_parts(const MergeOptions& options) {
  Parts parts;
  for (const auto& model : options.models) {
    auto document = read_document_file(model);
    if (!document) return document.error();
    for (Body& body : document->scene.bodies) {
      auto whole = untrimmed(body.surface, body.trims, trimmed_share * options.request.join.tolerance_m);
      if (!whole) return Error{model.string() + ": body \"" + body.name + "\": " + whole.error().message};
      parts.untrimmed_m = std::max(parts.untrimmed_m, whole->deviation_m);
      leave_out_shares(body, parts.remarks);
      parts.bodies.push_back(body);
      parts.patches.push_back(std::move(whole->surface));
    }
    if (!parts.first) parts.first = std::move(document).value();
  }
  return parts;
}

// Those that cross are merged one after the other, each by its share of the tolerance.
Result<Outcome> merged_surface(const Parts& parts, const MergeOptions& options, const Progress& progress) {
  const std::vector<Surface>& patches = parts.patches;
  MergeRequest request = options.request;
  request.join.continuity = continuity_of(options);
  request.join.progress = progress;
  if (!options.crossing) {
    request.join.spent_m = parts.untrimmed_m;
    auto merged = merge(patches, request);
    if (!merged) return merged.error();
    return Outcome{std::move(merged).value(), {}, {}, {}};
  }
  if (patches.size() < 2) return Error{"one body alone crosses none; name another one"};
  Outcome outcome{{patches[0], 0.0, {}}, {}, {}, {}};
  Merged& merged = outcome.merged;
  request.join.tolerance_m =
      (request.join.tolerance_m - parts.untrimmed_m) / static_cast<double>(patches.size() - 1);
  const double each = 1.0 / static_cast<double>(patches.size() - 1);
  for (std::size_t p = 1; p < patches.size(); ++p) {
    request.join.progress = progress.part(each * static_cast<double>(p - 1), each * static_cast<double>(p));
    auto next = merge_crossing(merged.surface, patches[p], {request.join, options.fillet_m});
    if (!next) return Error{"patch " + std::to_string(p + 1) + ": " + next.error().message};
    merged.surface = std::move(next->surface);
    merged.deviation_m += next->deviation_m;
    outcome.corners.push_back(next->corner);
    if (options.fillet_m > 0.0) {
      // Now, as long as it lies along v.
      const std::string which = patches.size() > 2 ? " with patch " + std::to_string(p + 1) : "";
      add_tight_fillet(merged.surface, next->corner, which, options.fillet_m, request.join.continuity,
                       outcome.tight_fillets);
    }
    if (next->first_was_inward) outcome.turned.push_back(p - 1);
    if (next->second_was_inward) outcome.turned.push_back(p);
  }
  return outcome;
}

Result<Outcome> merge_with_progress(const MergeOptions& options, const Parts& parts, Console& console) {
  WatchedWork work(console, "Merging", options.out);
  return work.done([&](const Progress& progress) { return merged_surface(parts, options, progress); });
}

Status merge_models(const MergeOptions& options, Console& console) {
  const int models = static_cast<int>(options.models.size());
  if (Status few = check_range("the number of models", models, model_count_range); !few) return few;
  auto parts = read_parts(options);
  if (!parts) return parts.error();
  auto outcome = merge_with_progress(options, parts.value(), console);
  if (!outcome) return outcome.error();
  outcome->merged.deviation_m += parts->untrimmed_m;
  const Document document =
      merged_document(*parts->first, parts->bodies, options, outcome->merged.surface, parts->remarks);
  add_remarks_of_merging(options, outcome.value(), parts->remarks);
  // A file becomes whole: what asks to stop now waits for it.
  const InterruptWatch until_written;
  if (Status written = write_document(document, options.out); !written) return written;
  report(options, parts.value(), outcome.value(), console);
  return {};
}

}  // namespace

CommandEntry add_merge(OptionSet root) {
  auto options = std::make_shared<MergeOptions>();
  const OptionSet parser = root.add_command("merge", "Make one surface of several patches");
  parser.set_footer(
      "The patches are the bodies of all models, counted from 1, and make a row, a ring or a full grid;\n"
      "which edges belong together is found by where they lie. Where the last lie on the first, as of a\n"
      "ring, the result is closed around. Closed bodies that do not touch are opened at their nearest\n"
      "ends and bridged. Where the continuity is there already the result is exact; elsewhere control\n"
      "points are added beside the joint until the tolerance holds. Trimmed bodies are resampled up to\n"
      "their trims, discs and rings about their middle. Material and tool are the first model's;\n"
      "regions, loads and supports of the patches are left out.\n"
      "Example: spoonbill merge bowl.json handle.json --continuity C2 --out spoon.json");
  parser.add_option("MODEL", options->models, "Documents (.json)").require();
  add_document_output(parser, options->out, "The merged document (.json)").require();
  parser.add_option("--name", options->name, "Of the result; the file's unless told");
  const JoinRequest& join = options->request.join;
  const auto length_in = [](Range<double> range) {
    return [range](const std::string& text) { return parse_length(text, range); };
  };
  add_parsed_option(
      parser, "--continuity", "C0..C8", parse_continuity,
      [options](int order) { options->continuity = order; },
      "Of the joints and a ring's seam, C2 unless told; of a fillet C1, for an arc that is to be C2 with "
      "what it touches gets "
      "tighter than its radius");
  add_parsed_option(
      parser, "--tolerance", "LENGTH", length_in(tolerance_range_m),
      [options](double length_m) { options->request.join.tolerance_m = length_m; },
      "How far the result may leave the patches outside blends, " + short_length_text(join.tolerance_m) +
          " unless told");
  add_parsed_option(
      parser, "--blend", "LENGTH", length_in(blend_range_m),
      [options](double length_m) { options->request.join.blend_m = length_m; },
      "Cut patches back where they are apart or do not meet as smoothly as asked, for a blend of this "
      "length; "
      "without it a kink is rounded within the tolerance, and a small gap that is no straight way on blended "
      "over a piece between two knots, 10 to 40 times the gap");
  parser
      .add_parsed_list(
          "--edges",
          [options](const std::vector<std::string>& texts) -> Status {
            for (const std::string& text : texts) {
              const auto pair = parse_edges(text);
              if (!pair) return pair.error();
              options->request.chosen.push_back(pair.value());
            }
            return {};
          },
          "Join these edges, instead of those found: 1.v_end:2.v_start, or 1.v_end:-2.v_start where the "
          "second runs against the first and 1.v_end:+2.v_start where along it; once for each joint")
      .show_as("EDGE:EDGE");
  CommandOption twist = add_parsed_option(
      parser, "--twist", "SHARE", parse_twist,
      [options](double share) { options->request.join.twist = share; },
      "Turn each ring by this share of a turn from where it fits the one before best");
  CommandOption crossing = parser.add_flag("--intersect", options->crossing,
                                           "The patches cross: each keeps what lies before the other");
  add_parsed_option(
      parser, "--fillet", "LENGTH", length_in(fillet_range_m),
      [options](double length_m) { options->fillet_m = length_m; },
      "Round the corner in which they cross with this radius")
      .need(crossing);
  // By then all have been read, in whichever order they came.
  parser.set_final_check([options]() -> Status {
    if (options->crossing && options->fillet_m == 0.0 && options->continuity.value_or(0) > 0) {
      return Error{
          "--continuity: without --fillet bodies that cross meet at an edge, which is C0; give a radius "
          "with --fillet, or leave it out"};
    }
    return {};
  });
  crossing.exclude(parser.option("--edges"));
  crossing.exclude(parser.option("--blend"));
  crossing.exclude(twist);
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return merge_models(*options, console); }};
}

}  // namespace spoonbill
