#include "engine/merging/merge.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/commands/surface_change.h"
#include "app/files/documents.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/inspection/curvature.h"
#include "engine/inspection/mass_properties.h"
#include "engine/inspection/surface_check.h"
#include "engine/merging/bring.h"
#include "engine/merging/intersection_merge.h"
#include "engine/merging/trimmed_patch.h"

namespace spoonbill {
namespace {

constexpr Range<double> merge_tolerance_range_m{1e-9, 0.1};
constexpr Range<double> blend_range_m{0.0, 1.0};
constexpr Range<double> fillet_range_m{0.0, 1.0};
constexpr Range<double> twist_range{-1.0, 1.0};
constexpr Range<int> model_count_range{1, 64};
// Fraction of the tolerance that resampling a trimmed patch may use.
constexpr double untrimming_fraction = 0.25;
// A fillet whose smallest radius is below this fraction of the requested radius gets a note.
constexpr double tight_fillet_fraction = 0.8;

struct MergeOptions {
  OutputOptions how;
  std::vector<std::filesystem::path> models;
  std::filesystem::path out;
  std::string name;
  MergeRequest request;
  std::optional<int> continuity;  // empty if --continuity is not given
  bool crossing = false;
  bool brings = false;
  double fillet_m = 0.0;
  bool json = false;
};

// The input of a merge.
struct MergeParts {
  // First document of the merge. The merged document gets the material and the tool of this document. If
  // there is only one patch, it also gets the view.
  std::optional<Document> first;
  std::vector<Body> bodies;
  std::vector<Surface> patches;      // surfaces of the bodies, resampled so that they have no trims
  std::vector<BroughtPart> brought;  // how patches after the first were moved; empty without --bring
  double untrimmed_m = 0.0;          // largest deviation that removing the trims caused
  std::vector<std::string> notes;
};

struct MergeOutcome {
  Merged merged;
  // corners[k] describes the corner between patches[k + 1] and the result of merging patches[0] to
  // patches[k].
  std::vector<Joint> corners;
  std::vector<std::string> tight_fillets;     // notes on fillets that are tighter than requested
  std::vector<std::size_t> reversed_patches;  // indices of patches whose normals pointed inwards
};

// Parses a fraction of a turn, such as "-0.25".
Result<double> parse_twist(const std::string& text) {
  double turns = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), turns);
  if (error == std::errc() && end == text.data() + text.size() && twist_range.contains(turns)) return turns;
  return Error{ErrorCode::out_of_range, "'" + excerpt(text) + "' is not a fraction of a turn from -1 to 1"};
}

// Parses an edge, such as "2.v_start" for the start of v on the second patch.
Result<PatchEdge> parse_edge(const std::string& text) {
  const std::size_t dot = text.find('.');
  if (dot == 0 || dot == std::string::npos || dot > 3 || text.find_first_not_of("0123456789") != dot) {
    return Error{
        ErrorCode::malformed,
        "'" + excerpt(text) + "' is not an edge; name one like 2.v_start, which belongs to the second patch"};
  }
  const auto side = parse_side(text.substr(dot + 1));
  if (!side) return side.error();
  return PatchEdge{std::stoi(text.substr(0, dot)) - 1, side.value()};
}

// Parses "1.v_end:2.v_start", or "1.v_end:-2.v_start" for edges that run in opposite directions.
Result<ChosenEdges> parse_edges(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    return Error{ErrorCode::malformed,
                 "'" + excerpt(text) + "' is not a pair of edges; name one like 1.v_end:2.v_start"};
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
    return Error{ErrorCode::inconsistent,
                 "'" + excerpt(text) + "' joins a patch to itself; name two patches"};
  }
  edges.a = a.value();
  edges.b = b.value();
  return edges;
}

// Returns the continuity of the joints. A sharp corner is C0. Otherwise the requested continuity applies; its
// default is C1 for a fillet, because a C2 fillet would be tighter than the requested radius.
int continuity_of(const MergeOptions& options) {
  if (options.crossing && options.fillet_m == 0.0) return 0;
  if (options.continuity) return *options.continuity;
  return options.crossing ? 1 : JoinRequest().continuity;
}

std::string edge_text(const PatchEdge& edge) {
  return std::to_string(edge.patch + 1) + "." + side_name(edge.side);
}

std::string edges_text(const PatchEdge& a, const PatchEdge& b) {
  return edge_text(a) + " and " + edge_text(b);
}

std::string joint_text(const MergedJoint& merged) {
  const Joint& joint = merged.joint;
  const std::string edges = edges_text(merged.a, merged.b);
  if (merged.closes) return edges + ", edge to edge, which closes the surface in this direction";
  if (!joint.bridged) return edges + ", edge to edge";
  if (joint.cut_back_m == 0.0) {
    return edges + ", bridged over a gap of " + short_length_text(joint.gap_m) + " by a blend of " +
           short_length_text(joint.blend_length_m);
  }
  return edges + ", up to " + short_length_text(joint.apart_m) + " apart, cut back by " +
         short_length_text(joint.cut_back_m) + " each for a blend of " +
         short_length_text(joint.blend_length_m);
}

Json joint_json(const std::string& a, const std::string& b, Direction along, const Joint& joint) {
  return {{"a", a},
          {"b", b},
          {"along", along == Direction::u ? "u" : "v"},
          {"bridged", joint.bridged},
          {"gap_m", joint.gap_m},
          {"apart_m", joint.apart_m},
          {"cut_back_m", joint.cut_back_m},
          {"blend_start", joint.blend_start},
          {"blend_end", joint.blend_end},
          {"blend_length_m", joint.blend_length_m}};
}

void add_joints(FactSheet& facts, const std::vector<MergedJoint>& joints) {
  Json list = Json::array();
  for (const MergedJoint& merged : joints) {
    facts.add("Joint", joint_text(merged), "", nullptr);
    list.push_back(joint_json(edge_text(merged.a), edge_text(merged.b), merged.along, merged.joint));
    list.back()["closes"] = merged.closes;
  }
  facts.add("", "", "joints", list);
}

std::string corner_text(const Joint& corner, bool is_last) {
  const std::string start = number_text(corner.blend_start), end = number_text(corner.blend_end);
  if (!corner.bridged) return "an edge" + (is_last ? " at v = " + start : "");
  return "a fillet " + short_length_text(corner.blend_length_m) + " long" +
         (is_last ? ", from v = " + start + " to " + end : "");
}

// Adds the facts of the corners between crossing bodies. Only the last corner is at constant v in the result,
// so only its position is reported.
void add_corners(FactSheet& facts, const std::vector<Joint>& corners) {
  Json list = Json::array();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const bool is_last = k + 1 == corners.size();
    const std::string second = std::to_string(k + 2);
    facts.add("Joint",
              (k == 0 ? "1 and " : "the result and ") + second + " at " + corner_text(corners[k], is_last),
              "", nullptr);
    list.push_back(joint_json("1", second, Direction::v, corners[k]));
    if (!is_last) list.back()["blend_start"] = list.back()["blend_end"] = nullptr;
  }
  facts.add("", "", "joints", list);
}

// Adds a note for each joint to which the requested blend was not applied.
void add_unused_blends(const std::vector<MergedJoint>& joints, std::vector<std::string>& notes) {
  for (const MergedJoint& merged : joints) {
    if (merged.joint.cut_back_m > 0.0) continue;
    notes.push_back("the blend was not applied to " + edges_text(merged.a, merged.b) +
                    (merged.closes          ? ": their seam is closed within the tolerance"
                     : merged.joint.bridged ? ": the gap between them is longer than the blend"
                                            : ": they already meet with the requested continuity"));
  }
}

// Returns the centres of the four quarters of every knot span that overlaps or touches the range from `start`
// to `end`.
std::vector<double> sample_spans(const KnotVector& knots, double start, double end) {
  constexpr int parts = 4;
  const std::vector<double> ends = knots.breakpoints();
  std::vector<double> parameters;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    if (ends[k + 1] < start || ends[k] > end) continue;
    for (int part = 0; part < parts; ++part) {
      parameters.push_back(ends[k] + (ends[k + 1] - ends[k]) * (part + 0.5) / parts);
    }
  }
  return parameters;
}

// Returns the smallest concave radius of curvature at samples of the fillet and of the knot spans beside it.
double tightest_radius_m(const Surface& merged, const Joint& corner) {
  double least = std::numeric_limits<double>::infinity();
  const KnotVector &u = merged.u, &v = merged.v;
  for (const double at_v : sample_spans(v, corner.blend_start, corner.blend_end)) {
    for (const double at_u : sample_spans(u, u.domain_start(), u.domain_end())) {
      const auto curvatures = compute_principal_curvatures(evaluate(merged, at_u, at_v));
      if (curvatures && curvatures->smallest < 0.0) least = std::min(least, -1.0 / curvatures->smallest);
    }
  }
  return least;
}

// Adds a note if the fillet is tighter than requested. `which` follows the words "the fillet" in the note,
// such as " with patch 3".
void add_tight_fillet(const Surface& merged, const Joint& corner, const std::string& which, double fillet_m,
                      int continuity, std::vector<std::string>& notes) {
  const double least_m = tightest_radius_m(merged, corner);
  if (!(least_m < tight_fillet_fraction * fillet_m)) return;
  notes.push_back("the fillet" + which + " has a radius of about " + short_length_text(least_m) +
                  " at its tightest, less than the requested " + short_length_text(fillet_m) +
                  (continuity > 1 ? ": an arc cannot be C2 with its neighbours; C1 keeps the radius"
                                  : "; a smaller tolerance brings it closer to the request"));
}

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

std::string turn_text(double turn_rad) {
  return number_text(std::round(turn_rad * degrees_per_radian * 100.0) / 100.0) + " deg";
}

void add_brought_parts(FactSheet& facts, const MergeParts& parts) {
  Json list = Json::array();
  for (const BroughtPart& brought : parts.brought) {
    const auto& [to, from, motion] = brought;
    const auto patch = static_cast<std::size_t>(from.patch);
    const Eigen::AngleAxisd turn(motion.pose.orientation);
    facts.add("Moved",
              "\"" + parts.bodies[patch].name + "\" by " + short_length_text(motion.moved_m.norm()) +
                  ", turned by " + turn_text(turn.angle()) + ", of which " + turn_text(motion.roll_rad) +
                  " about the joint, so that " + edge_text(from) + " meets " + edge_text(to),
              "", nullptr);
    list.push_back({{"patch", from.patch + 1},
                    {"edge", edge_text(from)},
                    {"meets", edge_text(to)},
                    {"edge_moved_mm", millimetres_json(motion.moved_m)},
                    {"turned_deg", turn.angle() * degrees_per_radian},
                    {"axis", {turn.axis().x(), turn.axis().y(), turn.axis().z()}},
                    {"roll_deg", motion.roll_rad * degrees_per_radian}});
  }
  if (!list.empty()) facts.add("", "", "moved", list);
}

void add_merge_notes(const MergeOptions& options, const MergeOutcome& outcome,
                     std::vector<std::string>& notes) {
  if (options.request.join.blend_m > 0.0) add_unused_blends(outcome.merged.joints, notes);
  for (const auto& [a, b, reason] : outcome.merged.left_open) {
    notes.push_back(edges_text(a, b) + " touch as well but are not joined: " + reason);
  }
  const Surface& surface = outcome.merged.surface;
  if (find_closing(surface).closedness == Closedness::solid &&
      compute_enclosed_mass(surface).volume_m3 < 0.0) {
    notes.emplace_back("the normals point inwards; reverse u with `spoonbill change`");
  }
  for (const std::size_t patch : outcome.reversed_patches) {
    notes.push_back("the normals of patch " + std::to_string(patch + 1) +
                    " pointed inwards; the patch was reversed before merging");
  }
  notes.insert(notes.end(), outcome.tight_fillets.begin(), outcome.tight_fillets.end());
}

void report_merge(const MergeOptions& options, const MergeParts& parts, const MergeOutcome& outcome,
                  Console& console) {
  const Merged& merged = outcome.merged;
  FactSheet facts;
  facts.add("File", options.out.string(), "file", options.out.string());
  Json names = Json::array();
  for (const Body& patch : parts.bodies) names.push_back(patch.name);
  facts.add("Patches", std::to_string(parts.bodies.size()), "patches", names);
  add_brought_parts(facts, parts);
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
  add_notes(facts, parts.notes);
  facts.print(console.out, options.json);
}

Document merged_document(const Document& first, const std::vector<Body>& patches, const MergeOptions& options,
                         Surface surface, std::vector<std::string>& notes) {
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
    document.view = Json::object();  // the default view frames the whole result
  }
  adapt_thickness(body, patches[0].surface, notes);
  document.scene.bodies = {std::move(body)};
  if (const std::string note = drop_unfit_trial(document.scene); !note.empty()) notes.push_back(note);
  return document;
}

Result<MergeParts> read_parts(const MergeOptions& options) {
  MergeParts parts;
  for (const auto& model : options.models) {
    auto document = read_document_file(model);
    if (!document) return document.error();
    if (Status surfaces = check_surfaces(document->scene.bodies, model); !surfaces) return surfaces.error();
    for (Body& body : document->scene.bodies) {
      auto whole =
          untrimmed(body.surface, body.trims, untrimming_fraction * options.request.join.tolerance_m);
      if (!whole) return whole.error().in("body \"" + body.name + "\"").in(model.string());
      parts.untrimmed_m = std::max(parts.untrimmed_m, whole->deviation_m);
      drop_surface_features(body, parts.notes);
      parts.bodies.push_back(body);
      parts.patches.push_back(std::move(whole->surface));
    }
    if (!parts.first) parts.first = std::move(document).value();
  }
  return parts;
}

// Merges crossing patches one after the other. Each merge may use an equal part of the tolerance that is left
// after the trims were removed.
Result<MergeOutcome> merge_crossing_patches(const MergeParts& parts, const MergeOptions& options,
                                            MergeRequest request, const Progress& progress) {
  const std::vector<Surface>& patches = parts.patches;
  if (patches.size() < 2) {
    return Error{ErrorCode::too_few, "merge: --intersect needs at least two bodies", "--intersect"};
  }
  MergeOutcome outcome{{patches[0], 0.0, {}}, {}, {}, {}};
  Merged& merged = outcome.merged;
  request.join.tolerance_m =
      (request.join.tolerance_m - parts.untrimmed_m) / static_cast<double>(patches.size() - 1);
  const double each = 1.0 / static_cast<double>(patches.size() - 1);
  for (std::size_t p = 1; p < patches.size(); ++p) {
    request.join.progress = progress.part(each * static_cast<double>(p - 1), each * static_cast<double>(p));
    auto next = merge_crossing(merged.surface, patches[p], {request.join, options.fillet_m});
    if (!next) return next.error().in("patch " + std::to_string(p + 1));
    merged.surface = std::move(next->surface);
    merged.deviation_m += next->deviation_m;
    outcome.corners.push_back(next->corner);
    if (options.fillet_m > 0.0) {
      // The fillet is measured before the next merge, because it is at constant v only until then.
      const std::string which = patches.size() > 2 ? " with patch " + std::to_string(p + 1) : "";
      add_tight_fillet(merged.surface, next->corner, which, options.fillet_m, request.join.continuity,
                       outcome.tight_fillets);
    }
    if (next->first_was_inward) outcome.reversed_patches.push_back(p - 1);
    if (next->second_was_inward) outcome.reversed_patches.push_back(p);
  }
  return outcome;
}

Status bring_if_wanted(const MergeOptions& options, MergeParts& parts) {
  if (!options.brings) return {};
  auto brought = bring_parts(parts.patches, options.request);
  if (!brought) return brought.error().in("merge");
  parts.brought = std::move(brought).value();
  return {};
}

Result<MergeOutcome> merge_parts(const MergeParts& parts, const MergeOptions& options,
                                 const Progress& progress) {
  MergeRequest request = options.request;
  request.join.continuity = continuity_of(options);
  request.join.progress = progress;
  if (options.crossing) return merge_crossing_patches(parts, options, std::move(request), progress);
  request.join.spent_m = parts.untrimmed_m;
  auto merged = merge(parts.patches, request);
  if (!merged) return merged.error();
  return MergeOutcome{std::move(merged).value(), {}, {}, {}};
}

Status merge_models(const MergeOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  const int models = static_cast<int>(options.models.size());
  if (Status few = check_range("the number of models", models, model_count_range); !few) return few;
  auto parts = read_parts(options);
  if (!parts) return parts.error();
  if (Status brought = bring_if_wanted(options, parts.value()); !brought) return brought;
  auto outcome = CancellableJob(console, "Merging", options.out).run([&](const Progress& progress) {
    return merge_parts(parts.value(), options, progress);
  });
  if (!outcome) return outcome.error();
  outcome->merged.deviation_m += parts->untrimmed_m;
  const Document document =
      merged_document(*parts->first, parts->bodies, options, outcome->merged.surface, parts->notes);
  add_merge_notes(options, outcome.value(), parts->notes);
  // Ctrl+C takes effect only when the file is complete.
  const InterruptWatch until_written;
  if (Status written = write_document(document, options.out, options.how); !written) return written;
  report_merge(options, parts.value(), outcome.value(), console);
  return {};
}

void add_joint_options(OptionSet parser, const std::shared_ptr<MergeOptions>& options) {
  const JoinRequest& join = options->request.join;
  const auto length_in = [](Range<double> range) {
    return [range](const std::string& text) { return parse_length(text, range); };
  };
  add_parsed_option(
      parser, "--continuity", "C0..C8", parse_continuity,
      [options](int order) { options->continuity = order; },
      "Continuity of joints and of a ring's seam; default: C2, or C1 for a fillet, because a C2 fillet is "
      "tighter than the given radius");
  add_parsed_option(
      parser, "--tolerance", "LENGTH", length_in(merge_tolerance_range_m),
      [options](double length_m) { options->request.join.tolerance_m = length_m; },
      "Largest distance of the result from the patches, except in blends; default: " +
          short_length_text(join.tolerance_m) + ", range: " + short_length_text(merge_tolerance_range_m.low) +
          " to " + short_length_text(merge_tolerance_range_m.high));
  add_parsed_option(
      parser, "--blend", "LENGTH", length_in(blend_range_m),
      [options](double length_m) { options->request.join.blend_m = length_m; },
      "Length of blends, up to 1 m; patches with a gap or a kink between them are cut back to make room. "
      "Default: none; a kink is rounded within the tolerance, and a small gap is bridged over a length of 10 "
      "to 40 times its width");
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
          "Edges to join, such as 1.v_end:2.v_start; -2.v_start if the second edge runs against the first, "
          "+2.v_start if it runs along the first. Given once per joint; default: the edges near each other")
      .show_as("EDGE:EDGE");
}

}  // namespace

CommandEntry add_merge(OptionSet root) {
  auto options = std::make_shared<MergeOptions>();
  const OptionSet parser = root.add_command("merge", "Merge patches into one surface");
  parser.set_footer(
      "The patches are the bodies of all models, numbered from 1. They form a row, a ring or a full grid;\n"
      "edges that are near each other are joined. If the last patch meets the first, the result is closed.\n"
      "Closed bodies that do not touch are opened at their nearest ends and bridged. A joint that already\n"
      "has the requested continuity is exact; elsewhere control points are added beside the joint until\n"
      "the error is within the tolerance. Trimmed bodies are resampled up to their trims; discs and rings\n"
      "are resampled about their centre. Material and tool are those of the first model; regions, loads,\n"
      "supports and rims are dropped.\n"
      "Example: spoonbill merge assets/models/spoon-handle.json assets/models/spoon-bowl.json --out "
      "spoon.json");
  parser.add_option("MODEL", options->models, "Documents (.json), 1 to 64").require();
  add_force_option(parser, options->how);
  add_document_output(parser, options->out).require();
  parser.add_option("--name", options->name, "Name of the result; default: the name of the --out file");
  add_joint_options(parser, options);
  CommandOption twist = add_parsed_option(
      parser, "--twist", "TURNS", parse_twist,
      [options](double turns) { options->request.join.twist = turns; },
      "Rotation of each ring relative to the ring before, measured from the best match, in turns; default: "
      "0, range: -1 to 1");
  CommandOption bring = parser.add_flag(
      "--bring", options->brings,
      "Move each patch after the first to where its edge meets one of a patch before it, in position, "
      "direction and roll: the edges of --edges, or the nearest ends of tubes");
  CommandOption crossing = parser.add_flag("--intersect", options->crossing,
                                           "Merge patches that cross: each keeps the part outside the other");
  add_parsed_option(
      parser, "--fillet", "LENGTH",
      [](const std::string& text) { return parse_length(text, fillet_range_m); },
      [options](double length_m) { options->fillet_m = length_m; },
      "Radius of the fillet where patches cross, up to 1 m; default: none, a sharp edge")
      .need(crossing);
  // The options may be given in any order, so the check runs after all are parsed.
  parser.set_final_check([options]() -> Status {
    if (options->crossing && options->fillet_m == 0.0 && options->continuity.value_or(0) > 0) {
      return Error{ErrorCode::inconsistent,
                   "--continuity: without --fillet, crossing bodies meet at a sharp edge, which is C0; add "
                   "--fillet, or remove --continuity",
                   "--continuity"};
    }
    return {};
  });
  crossing.exclude(bring);
  crossing.exclude(parser.option("--edges"));
  crossing.exclude(parser.option("--blend"));
  crossing.exclude(twist);
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return merge_models(*options, console); }};
}

}  // namespace spoonbill
