#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/files/document_file.h"
#include "app/interrupt.h"
#include "app/report/check_facts.h"
#include "app/report/progress_bar.h"

namespace spoonbill {
namespace {

struct CheckOptions {
  std::filesystem::path model;
  bool json = false;
};

// The bodies' facts as JSON, in their order.
Result<Json> check_bodies(FactSheet& facts, const std::vector<Body>& all, Console& console) {
  constexpr double whole = 1000.0;
  InterruptWatch interrupt;
  ProgressBar progress(console, "Checking", false);
  Json bodies = Json::array();
  for (const Body& body : all) {
    const auto trim = trim_of(body);
    if (!trim) return Error{"body \"" + body.name + "\": " + trim.error().message};
    const TrimmedArea area = trim.value() ? *trim.value() : TrimmedArea();
    const double done = static_cast<double>(bodies.size());
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
    bodies.push_back(add_check_facts(facts, body, area, *check));
  }
  return bodies;
}

Status check(const CheckOptions& options, Console& console) {
  const auto document = read_document_file(options.model);
  if (!document) return document.error();
  FactSheet facts;
  facts.add("File", options.model.string(), "file", options.model.string());
  const auto bodies = check_bodies(facts, document->scene.bodies, console);
  if (!bodies) return Error{options.model.string() + ": " + bodies.error().message};
  const bool sound =
      std::all_of(bodies->begin(), bodies->end(), [](const Json& body) { return body["sound"].get<bool>(); });
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
      "made of. Sound is a body that encloses what it is made of and meets itself nowhere. The exit code is\n"
      "0 whatever was found; \"sound\" in the JSON tells.\n"
      "Example: spoonbill check assets/models/spoon-handle.json");
  parser->add_option("MODEL", options->model, "A document (.json)")->required();
  add_json_option(*parser, options->json);
  return {parser, [options](Console& console) { return check(*options, console); }};
}

}  // namespace spoonbill
