#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/files/cad_file.h"
#include "app/files/documents.h"
#include "app/report/check_facts.h"
#include "app/report/document_facts.h"
#include "engine/inspection/solid_check.h"

namespace spoonbill {
namespace {

struct CheckOptions {
  std::filesystem::path model;
  bool json = false;
};

// Chord error of the meshes on which solids are measured, as a fraction of the model's size.
constexpr double solid_chord_fraction = 1e-3;
constexpr Range<double> solid_chord_range_m{1e-6, 2e-4};
constexpr std::size_t solid_triangle_limit = 5'000'000;

double size_of(const std::vector<Body>& bodies) {
  Box box = extent_of(bodies.front().surface, bodies.front().trims);
  for (const Body& body : bodies) box = joined(box, extent_of(body.surface, body.trims));
  return box.size();
}

bool are_all_sound(const Json& facts) {
  return std::all_of(facts.begin(), facts.end(), [](const Json& one) { return one["sound"].get<bool>(); });
}

CadModel make_model(const std::vector<Body>& bodies) {
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

// Joins the faces of each solid that consists of several bodies.
Result<CadSolids> join_solids(const CheckOptions& options, const std::vector<Body>& all,
                              const InterruptWatch& interrupt) {
  if (std::all_of(all.begin(), all.end(), [](const Body& body) { return body.solid.empty(); })) {
    return CadSolids();
  }
  CadChild child;
  child.progress = Progress([&](double) { return !interrupt.requested(); });
  const CadModel model = make_model(all);
  const double chord_m =
      std::clamp(solid_chord_fraction * size_of(all), solid_chord_range_m.low, solid_chord_range_m.high);
  auto solids = make_cad_solids(model, {chord_m, solid_triangle_limit}, options.model, child);
  // If the meshing fails, for example with too many triangles, it is repeated with the largest chord error.
  if (solids || interrupt.requested() || chord_m == solid_chord_range_m.high) return solids;
  return make_cad_solids(model, {solid_chord_range_m.high, solid_triangle_limit}, options.model, child);
}

std::vector<const Surface*> surfaces_of(const CadSolid& solid, const std::vector<Body>& all) {
  std::vector<const Surface*> surfaces;
  for (const std::size_t body : solid.surface_indices) surfaces.push_back(&all[body].surface);
  return surfaces;
}

// Adds the facts of the solids and returns their JSON.
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
      return Progress::stopped();
    }
    json.push_back(add_solid_check_facts(facts, solid, *check, all));
  }
  for (Json& open : add_open_solid_facts(facts, solids.loose, all)) json.push_back(std::move(open));
  for (const std::string& note : solids.notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", solids.notes);
  return json;
}

struct CheckedBodies {
  Json facts = Json::array();  // one entry per body
  // Indices of the bodies that enclose their material. Shells and faces of solids are not included.
  std::vector<std::size_t> solids;
};

Result<CheckedBodies> check_bodies(FactSheet& facts, const std::vector<Body>& all,
                                   const std::set<std::size_t>& faces, InterruptWatch& interrupt,
                                   Console& console) {
  ProgressBar bar(console, "Checking", false);
  CheckedBodies checked;
  Json& bodies = checked.facts;
  for (const Body& body : all) {
    const auto trim = make_trimmed_area(body);
    if (!trim) return trim.error().in("body \"" + body.name + "\"");
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
      return Progress::stopped();
    }
    const bool is_solid = as == CheckedAs::body && !body.shell_thickness_m && check->encloses();
    if (is_solid && check->mass.volume_m3 > 0.0) checked.solids.push_back(bodies.size());
    bodies.push_back(add_check_facts(facts, body, as, area, *check));
  }
  return checked;
}

// Adds the facts of overlapping solid bodies.
Status check_overlaps(FactSheet& facts, const std::vector<std::size_t>& solids, const std::vector<Body>& all,
                      InterruptWatch& interrupt) {
  std::vector<const Surface*> surfaces;
  surfaces.reserve(solids.size());
  for (const std::size_t body : solids) surfaces.push_back(&all[body].surface);
  const auto meetings =
      find_body_overlaps(surfaces, Progress([&](double) { return !interrupt.requested(); }));
  if (!meetings) {
    interrupt.answer();
    return Progress::stopped();
  }
  Json json = Json::array();
  for (const BodyOverlap& meeting : meetings->found) {
    json.push_back(
        add_meeting_facts(facts, meeting, all[solids[meeting.first]], all[solids[meeting.second]]));
  }
  facts.add("", "", "meetings", std::move(json));
  facts.add(meetings->complete ? "" : "Notice",
            "bodies are close at more points than could be searched; some overlaps may be missing",
            "meetings_complete", meetings->complete);
  return {};
}

Status check(const CheckOptions& options, Console& console) {
  const auto document = read_document_file(options.model);
  if (!document) return document.error();
  if (Status surfaces = check_surfaces(document->scene.bodies, options.model); !surfaces) return surfaces;
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
  for (const CadSolid& solid : solids->solids)
    faces.insert(solid.surface_indices.begin(), solid.surface_indices.end());
  const auto solid_facts = check_solids(facts, solids.value(), all, interrupt, console);
  if (!solid_facts) return solid_facts.error().in(options.model.string());
  const auto bodies = check_bodies(facts, all, faces, interrupt, console);
  if (!bodies) return bodies.error().in(options.model.string());
  if (all.size() > 1) {
    const Status met = check_overlaps(facts, bodies->solids, all, interrupt);
    if (!met) return met.error().in(options.model.string());
  }
  facts.add("", "", "solids", solid_facts.value());
  facts.add("", "", "sound", are_all_sound(solid_facts.value()) && are_all_sound(bodies->facts));
  facts.add("", "", "bodies", bodies->facts);
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_check(OptionSet root) {
  auto options = std::make_shared<CheckOptions>();
  const OptionSet parser = root.add_command(
      "check", "Check whether a model's bodies are sound, and measure thickness and curvature");
  parser.set_footer(
      "Reports for each body whether its surface is closed, intersects itself, folds or has no area;\n"
      "volume, area, mass and centre of mass; principal curvatures, positive where convex; the smallest\n"
      "convex and concave radii; the smallest thickness; the positions of all these; and the bending, the\n"
      "integral of both curvatures squared, which is small for a fair surface. The thickness is measured\n"
      "straight inwards from samples a third of a knot span apart. It counts only if the line meets the\n"
      "opposite wall within 50 degrees of that wall's normal, so that blunt edges do not count as thin.\n"
      "Trimmed areas do not count, and regions have the mass of their material. Bodies that are faces of\n"
      "one solid, as in parts from CAD, are joined into that solid if they close; the solid has the volume,\n"
      "area, mass, centre and smallest thickness. Its thickness is measured on a mesh, and the error is\n"
      "reported. Solid bodies that overlap are listed with their depth; an overlap alone is not a fault. A\n"
      "body is sound if it does not intersect itself and either encloses its material or is a face of a\n"
      "solid that does. The exit code is 0 for any result; see \"sound\" in the JSON.\n"
      "Example: spoonbill check assets/models/spoon-handle.json");
  parser.add_option("MODEL", options->model, "Document (.json)").require();
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return check(*options, console); }};
}

}  // namespace spoonbill
