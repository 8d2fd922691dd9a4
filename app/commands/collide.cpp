#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/option_values.h"
#include "app/report/contact_facts.h"
#include "engine/collision/surface_pair_collider.h"
#include "engine/exchange/document.h"
#include "engine/material/tube_lattice.h"

namespace spoonbill {
namespace {

struct CollideOptions {
  std::filesystem::path first, second;
  Pose pose;
  bool json = false;
};

// Cells a quarter of an element wide: regions are told that closely.
constexpr int levels = 2;

Result<Surface> read_body(const std::filesystem::path& file) {
  auto document = read_document(file);
  if (!document) return document.error();
  Surface surface = std::move(document->scene.bodies[0].surface);
  if (Status closed = check_closed_tube(surface); !closed) {
    return Error{file.string() + ": " + closed.error().message};
  }
  return surface;
}

Status collide(const CollideOptions& options, Console& console) {
  const auto first = read_body(options.first);
  if (!first) return first.error();
  const auto second = read_body(options.second);
  if (!second) return second.error();
  const Surface& a = first.value();
  const Surface b = placed(second.value(), options.pose);
  const auto grid_a = make_nested_grid(a.u, a.v, levels), grid_b = make_nested_grid(b.u, b.v, levels);
  if (!grid_a) return grid_a.error();
  if (!grid_b) return grid_b.error();

  SurfacePairCollider collider(grid_a.value(), grid_b.value());
  PairQuery query;
  query.first_closed = query.second_closed = true;
  query.reach_m = std::numeric_limits<double>::infinity();
  const PairResult result = collider.collide(a, b, query);
  if (result.overflow && !result.touching) {
    return Error{
        "these surfaces come near each other in more places than can be searched: " + options.first.string() +
        " and " + options.second.string() + "; give them fewer control points or another --pose"};
  }
  FactSheet facts;
  facts.add("A", options.first.string(), "a", options.first.string());
  facts.add("B", options.second.string(), "b", options.second.string());
  add_contact_facts(facts, result, collider.contacts());
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_collide(CLI::App& root) {
  auto options = std::make_shared<CollideOptions>();
  CLI::App* parser = root.add_subcommand("collide", "Tell whether and how deep two models touch");
  parser->footer(
      "Found on the B-spline surfaces themselves, to a micrometre: where they touch, how deep, which way A\n"
      "gets out, and the parameters on both; where they do not, the distance and the nearest points.\n"
      "Example: spoonbill collide assets/models/spoon-handle.json assets/models/spoon-handle.json "
      "--pose 0,5mm,0,1,0,0,0");
  parser->add_option("A", options->first, "A document (.json)")->required();
  parser->add_option("B", options->second, "Another, or the same")->required();
  parser
      ->add_option_function<std::string>(
          "--pose",
          [options](const std::string& text) {
            const auto pose = parse_pose(text);
            if (!pose) throw CLI::ValidationError("--pose", pose.error().message);
            options->pose = pose.value();
          },
          "Where B is: x,y,z, each with its unit (mm, cm, m or in) unless 0, and a turn as a quaternion "
          "w,x,y,z")
      ->type_name("X,Y,Z,QW,QX,QY,QZ");
  add_json_option(*parser, options->json);
  return {parser, [options](Console& console) { return collide(*options, console); }};
}

}  // namespace spoonbill
