#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/option_set.h"
#include "app/files/cad_file.h"
#include "app/files/document_file.h"
#include "app/interrupt.h"
#include "app/report/check_facts.h"
#include "app/report/progress_bar.h"
#include "app/report/solid_check_facts.h"
#include "app/report/surface_extent.h"
#include "engine/inspection/solid_check.h"

namespace spoonbill {
namespace {

struct CheckOptions {
  std::filesystem::path model;
  bool json = false;
};

// Of the model's size, how near to a solid the mesh is that tells its thickness and where it meets itself.
constexpr double chord_share = 1e-3;
constexpr Range<double> chord_range_m{1e-6, 2e-4};
constexpr std::size_t triangle_limit = 5'000'000;

double size_of(const std::vector<Body>& bodies) {
  Box box = extent_of(bodies.front().surface, bodies.front().trims);
  for (const Body& body : bodies) box = joined(box, extent_of(body.surface, body.trims));
  return box.size();
}

bool all_sound(const Json& facts) {
  return std::all_of(facts.begin(), facts.end(), [](const Json& one) { return one["sound"].get<bool>(); });
}

CadModel model_of(const std::vector<Body>& bodies) {
  CadModel model;
  for (const Body& body : bodies) {
    CadSurface surface;
    surface.name = body.name;
    surface.surface = body.surface;
    surface.trims = body.trims;
    surface.solid = body.solid;
    model.surfaces.push_back(std::move(surface));
  }
  return model;
}

// Those that several bodies bound; an Error where there are some that cannot be joined.
Result<CadSolids> join_solids(const CheckOptions& options, const std::vector<Body>& all,
                              const InterruptWatch& interrupt) {
  if (std::all_of(all.begin(), all.end(), [](const Body& body) { return body.solid.empty(); })) {
    return CadSolids();
  }
  CadChild child;
  child.progress = Progress([&](double) { return !interrupt.requested(); });
  const CadModel model = model_of(all);
  const double chord_m = std::clamp(chord_share * size_of(all), chord_range_m.low, chord_range_m.high);
  auto solids = make_cad_solids(model, {chord_m, triangle_limit}, options.model, child);
  // What takes too many triangles may be told less exactly.
  if (solids || interrupt.requested() || chord_m == chord_range_m.high) return solids;
  return make_cad_solids(model, {chord_range_m.high, triangle_limit}, options.model, child);
}

std::vector<const Surface*> surfaces_of(const CadSolid& solid, const std::vector<Body>& all) {
  std::vector<const Surface*> surfaces;
  for (const std::size_t place : solid.places) surfaces.push_back(&all[place].surface);
  return surfaces;
}

// The solids' facts as JSON.
Result<Json> check_solids(FactSheet& facts, const CadSolids& solids, const std::vector<Body>& all,
                          InterruptWatch& interrupt, Console& console) {
  ProgressBar bar(console, "Checking solids", false);
  Json json = Json::array();
  for (const CadSolid& solid : solids.solids) {
    const double done = static_cast<double>(json.size());
    const Progress progress([&](double fraction) {
      bar.show((done + fraction) / static_cast<double>(solids.solids.size()));
      return !interrupt.requested();
    });
    const auto check = check_solid(solid.mesh, surfaces_of(solid, all), solid.chord_error_m, progress);
    if (!check) {
      interrupt.answer();
      return Error{"stopped"};
    }
    json.push_back(add_solid_check_facts(facts, solid, *check, all));
  }
  for (Json& open : add_open_solid_facts(facts, solids.loose, all)) json.push_back(std::move(open));
  for (const std::string& note : solids.notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", solids.notes);
  return json;
}

struct CheckedBodies {
  Json facts = Json::array();       // of the bodies, in their order
  std::vector<std::size_t> solids;  // those that enclose what they are made of, and are no faces
};

Result<CheckedBodies> check_bodies(FactSheet& facts, const std::vector<Body>& all,
                                   const std::set<std::size_t>& faces, InterruptWatch& interrupt,
                                   Console& console) {
  ProgressBar bar(console, "Checking", false);
  CheckedBodies checked;
  Json& bodies = checked.facts;
  for (const Body& body : all) {
    const auto trim = make_trimmed_area(body);
    if (!trim) return Error{"body \"" + body.name + "\": " + trim.error().message};
    const TrimmedArea area = trim.value() ? *trim.value() : TrimmedArea();
    const double done = static_cast<double>(bodies.size());
    const CheckedAs as = faces.contains(bodies.size()) ? CheckedAs::face : CheckedAs::body;
    const Progress progress([&](double fraction) {
      bar.show((done + fraction) / static_cast<double>(all.size()));
      return !interrupt.requested();
    });
    const auto check = check_surface(body.surface, area, progress);
    if (!check) {
      interrupt.answer();
      return Error{"stopped"};
    }
    const bool is_solid = as == CheckedAs::body && !body.shell_thickness_m && check->encloses();
    if (is_solid && check->mass.volume_m3 > 0.0) checked.solids.push_back(bodies.size());
    bodies.push_back(add_check_facts(facts, body, as, area, *check));
  }
  return checked;
}

// Adds where solid bodies are in each other.
Status check_meetings(FactSheet& facts, const std::vector<std::size_t>& solids, const std::vector<Body>& all,
                      InterruptWatch& interrupt) {
  std::vector<const Surface*> surfaces;
  surfaces.reserve(solids.size());
  for (const std::size_t place : solids) surfaces.push_back(&all[place].surface);
  const auto meetings =
      find_body_overlaps(surfaces, Progress([&](double) { return !interrupt.requested(); }));
  if (!meetings) {
    interrupt.answer();
    return Error{"stopped"};
  }
  Json json = Json::array();
  for (const BodyOverlap& meeting : meetings->found) {
    json.push_back(
        add_meeting_facts(facts, meeting, all[solids[meeting.first]], all[solids[meeting.second]]));
  }
  facts.add("", "", "meetings", std::move(json));
  facts.add(meetings->complete ? "" : "Notice",
            "bodies are near each other in more places than could be searched", "meetings_complete",
            meetings->complete);
  return {};
}

Status check(const CheckOptions& options, Console& console) {
  const auto document = read_document_file(options.model);
  if (!document) return document.error();
  FactSheet facts;
  facts.add("File", options.model.string(), "file", options.model.string());
  const std::vector<Body>& all = document->scene.bodies;
  InterruptWatch interrupt;
  auto solids = join_solids(options, all, interrupt);
  if (!solids) {
    CadSolids none;
    none.notes.push_back("the faces of solids are not joined: " + solids.error().message);
    solids = std::move(none);
  }
  std::set<std::size_t> faces;
  for (const CadSolid& solid : solids->solids) faces.insert(solid.places.begin(), solid.places.end());
  const auto solid_facts = check_solids(facts, solids.value(), all, interrupt, console);
  if (!solid_facts) return Error{options.model.string() + ": " + solid_facts.error().message};
  const auto bodies = check_bodies(facts, all, faces, interrupt, console);
  if (!bodies) return Error{options.model.string() + ": " + bodies.error().message};
  if (all.size() > 1) {
    const Status met = check_meetings(facts, bodies->solids, all, interrupt);
    if (!met) return Error{options.model.string() + ": " + met.error().message};
  }
  facts.add("", "", "solids", solid_facts.value());
  facts.add("", "", "sound", all_sound(solid_facts.value()) && all_sound(bodies->facts));
  facts.add("", "", "bodies", bodies->facts);
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_check(OptionSet root) {
  auto options = std::make_shared<CheckOptions>();
  const OptionSet parser =
      root.add_command("check", "Tell whether a model's bodies are sound, and how thick and curved");
  parser.set_footer(
      "Of each body: whether its surface is closed, passes through itself, folds or loses its area; volume,\n"
      "area, mass and its centre; principal curvatures, above zero where convex; the smallest convex and\n"
      "hollow radius; the smallest thickness, straight inwards from samples a third of a knot span apart to\n"
      "where the line goes out within 50 degrees of straight, so that blunter edges are not thin; the\n"
      "places of all these; and how bent it is, the integral of both curvatures' squares, which is small\n"
      "where a surface is fair. What trims take away does not count, and regions weigh what they are made\n"
      "of. Bodies that are faces of one solid, as CAD parts come in, are that solid where they close, and\n"
      "are judged as faces: its volume, area, mass and centre, whether faces pass through each other, and\n"
      "its smallest thickness, searched on a mesh of it, beside which no wall is thinner by more than is\n"
      "told. Of several solid bodies: which are in each other, and how deep; that alone is no fault. Sound\n"
      "is a body or a solid that encloses what it is made of, and a face of such a solid, that meets itself\n"
      "nowhere. The exit code is 0 whatever was found; \"sound\" in the JSON tells.\n"
      "Example: spoonbill check assets/models/spoon-handle.json");
  parser.add_option("MODEL", options->model, "A document (.json)").require();
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return check(*options, console); }};
}

}  // namespace spoonbill
