#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/files/cad_file.h"
#include "app/files/document_file.h"
#include "app/interrupt.h"
#include "app/report/check_facts.h"
#include "app/report/progress_bar.h"
#include "app/report/solid_check_facts.h"

namespace spoonbill {
namespace {

struct CheckOptions {
  std::filesystem::path model;
  bool json = false;
};

// Of the mesh that a solid is joined through; its numbers are those of its surfaces.
constexpr double chord_m = 2e-4;
constexpr std::size_t triangle_limit = 5'000'000;

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
  child.stop = [&] { return interrupt.requested(); };
  return make_cad_solids(model_of(all), {chord_m, triangle_limit}, options.model, child);
}

Json check_solids(FactSheet& facts, const CadSolids& solids, const std::vector<Body>& all) {
  Json json = Json::array();
  for (const CadSolid& solid : solids.solids) json.push_back(add_solid_check_facts(facts, solid, all));
  for (Json& open : add_open_solid_facts(facts, solids.loose, all)) json.push_back(std::move(open));
  for (const std::string& note : solids.notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", solids.notes);
  return json;
}

// The bodies' facts as JSON, in their order.
Result<Json> check_bodies(FactSheet& facts, const std::vector<Body>& all, const std::set<std::size_t>& faces,
                          InterruptWatch& interrupt, Console& console) {
  constexpr double whole = 1000.0;
  ProgressBar progress(console, "Checking", false);
  Json bodies = Json::array();
  for (const Body& body : all) {
    const auto trim = trim_of(body);
    if (!trim) return Error{"body \"" + body.name + "\": " + trim.error().message};
    const TrimmedArea area = trim.value() ? *trim.value() : TrimmedArea();
    const double done = static_cast<double>(bodies.size());
    const CheckedAs as = faces.contains(bodies.size()) ? CheckedAs::face : CheckedAs::body;
    const auto watch = [&](double share) {
      const double of_all = (done + share) / static_cast<double>(all.size());
      progress.show(static_cast<std::uint64_t>(whole * of_all), static_cast<std::uint64_t>(whole));
      return !interrupt.requested();
    };
    const auto check = check_surface(body.surface, area, watch);
    if (!check) {
      interrupt.answer();
      return Error{"stopped"};
    }
    bodies.push_back(add_check_facts(facts, body, as, area, *check));
  }
  return bodies;
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
  const Json solid_facts = check_solids(facts, solids.value(), all);
  const auto bodies = check_bodies(facts, all, faces, interrupt, console);
  if (!bodies) return Error{options.model.string() + ": " + bodies.error().message};
  const bool sound =
      std::all_of(bodies->begin(), bodies->end(), [](const Json& body) { return body["sound"].get<bool>(); });
  facts.add("", "", "solids", solid_facts);
  facts.add("", "", "sound", sound);
  facts.add("", "", "bodies", bodies.value());
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_check(CLI::App& root) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* parser =
      root.add_subcommand("check", "Tell whether a model's bodies are sound, and how thick and curved");
  parser->footer(
      "Of each body: whether its surface is closed, passes through itself, folds or loses its area; volume,\n"
      "area, mass and its centre; principal curvatures, above zero where convex; the smallest convex and\n"
      "hollow radius; the smallest thickness, straight inwards from samples a third of a knot span apart,\n"
      "with the places of all these; and how bent it is, the integral of both curvatures' squares, which is\n"
      "small where a surface is fair. What trims take away does not count, and regions weigh what they are\n"
      "made of. Bodies that are faces of one solid, as CAD parts come in, are that solid where they close: "
      "its\n"
      "volume, area, mass and centre are told, and they are judged as faces. Sound is a body that encloses\n"
      "what it is made of, or is a face of a solid that does, and meets itself nowhere. The exit code is 0\n"
      "whatever was found; \"sound\" in the JSON tells.\n"
      "Example: spoonbill check assets/models/spoon-handle.json");
  parser->add_option("MODEL", options->model, "A document (.json)")->required();
  add_json_option(*parser, options->json);
  return {parser, [options](Console& console) { return check(*options, console); }};
}

}  // namespace spoonbill
