#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/report/check_facts.h"
#include "app/report/progress_bar.h"
#include "engine/exchange/document.h"

namespace spoonbill {
namespace {

struct CheckOptions {
  std::filesystem::path model;
  bool json = false;
};

Status check(const CheckOptions& options, Console& console) {
  const auto document = read_document(options.model);
  if (!document) return document.error();
  FactSheet facts;
  facts.add("File", options.model.string(), "file", options.model.string());
  Json bodies = Json::array();
  bool sound = true;
  {
    ProgressBar progress(console, "Checking", false);
    const std::vector<Body>& all = document->scene.bodies;
    for (std::size_t b = 0; b < all.size(); ++b) {
      progress.show(b, all.size());
      bodies.push_back(add_check_facts(facts, all[b], check_surface(all[b].surface)));
      sound = sound && bodies.back()["sound"].get<bool>();
    }
  }
  facts.add("", "", "sound", sound);
  facts.add("", "", "bodies", bodies);
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
      "with the places of all these. Sound is a body that encloses what it is made of and meets itself\n"
      "nowhere. The exit code is 0 whatever was found; \"sound\" in the JSON tells.\n"
      "Example: spoonbill check assets/models/spoon-handle.json");
  parser->add_option("MODEL", options->model, "A document (.json)")->required();
  add_json_option(*parser, options->json);
  return {parser, [options](Console& console) { return check(*options, console); }};
}

}  // namespace spoonbill
