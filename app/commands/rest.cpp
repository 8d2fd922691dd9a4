#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/option_set.h"
#include "app/files/document_file.h"
#include "app/report/fact_sheet.h"
#include "app/report/progress_bar.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/base/progress.h"
#include "engine/simulation/rest_shape.h"

namespace spoonbill {
namespace {

struct RestOptions {
  std::filesystem::path model, out;
  bool json = false;
};

Json numbers(const Vector3& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

void add_if_not_elastic(const Material& material, FactSheet& facts) {
  if (is_linear_elastic(material)) return;
  facts.add("  Material", material.name + ", as if it were elastic", "", nullptr);
}

void add_body(FactSheet& facts, const Body& body, const RestShape& shape, Json& list) {
  const auto furthest = static_cast<std::size_t>(shape.furthest_node);
  const Vector3 displacement = shape.result.displacement_m[furthest], place = shape.mesh.nodes[furthest];
  facts.add("Body", body.name, "", nullptr);
  facts.add("  Held nodes",
            std::to_string(shape.held_nodes) + " of " + std::to_string(shape.mesh.node_count()), "", nullptr);
  facts.add("  Displaced", "at most " + short_length_text(displacement.norm()) + ", at " + position_text(place),
            "", nullptr);
  facts.add("  Loads", newtons_text(shape.load_n.norm()) + " together", "", nullptr);
  facts.add("  Reactions", newtons_text(shape.reaction_n.norm()) + " together", "", nullptr);
  facts.add("  Strain",
            "at most " + percent_text(std::abs(shape.largest_strain)) +
                (shape.largest_strain < 0.0 ? " pressed" : " stretched") + ", at " +
                position_text(shape.largest_strain_position_m),
            "", nullptr);
  add_if_not_elastic(body.material, facts);
  for (const MaterialRegion& region : body.regions) {
    if (region.material) add_if_not_elastic(*region.material, facts);
  }
  list.push_back({{"name", body.name},
                  {"nodes", shape.mesh.node_count()},
                  {"held_nodes", shape.held_nodes},
                  {"largest_displacement_m", displacement.norm()},
                  {"displacement_m", numbers(displacement)},
                  {"displaced_m", numbers(place)},
                  {"load_n", numbers(shape.load_n)},
                  {"reaction_n", numbers(shape.reaction_n)},
                  {"largest_strain", shape.largest_strain},
                  {"strained_m", numbers(shape.largest_strain_position_m)},
                  {"energy_j", shape.result.energy_j},
                  {"newton_steps", shape.result.newton_steps}});
}

// In the shape that the loads gave them, bodies bear them no more: they would bend twice.
void leave_unloaded(Scene& scene) {
  scene.sculpting.gravity_m_per_s2.setZero();
  for (Body& body : scene.bodies) {
    body.loads.clear();
    for (Support& support : body.supports) support.motion.reset();
  }
}

Status rest(const RestOptions& options, Console& console) {
  auto document = read_document_file(options.model);
  if (!document) return document.error();
  Scene& scene = document->scene;
  if (Status few = check_body_count(scene); !few) {
    return Error{options.model.string() + ": " + few.error().message};
  }
  FactSheet facts;
  facts.add("File", options.model.string(), "file", options.model.string());
  Json list = Json::array();
  std::vector<Surface> bent;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    ProgressBar bar(console, "Bending " + body.name, false);
    const auto shape = compute_rest_shape(scene, static_cast<int>(b), Progress([&](double fraction) {
                                    bar.show(fraction);
                                    return true;
                                  }));
    if (!shape) {
      return Error{options.model.string() + ": body \"" + body.name + "\": " + shape.error().message};
    }
    add_body(facts, body, shape.value(), list);
    bent.push_back(shape->surface);
  }
  facts.add("", "", "bodies", list);
  if (!options.out.empty()) {
    for (std::size_t b = 0; b < bent.size(); ++b) scene.bodies[b].surface = std::move(bent[b]);
    leave_unloaded(scene);
    if (Status written = write_document(document.value(), options.out); !written) return written;
  }
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_rest(OptionSet root) {
  auto options = std::make_shared<RestOptions>();
  const OptionSet parser = root.add_command("rest", "Tell how bodies rest under gravity and their loads");
  parser.set_footer(
      "Each body by itself, with the stiffness of its material, in equilibrium under the document's "
      "gravity,\n"
      "its loads and its supports: how far it bends, what its supports bear, how much it is strained. The\n"
      "ground and other bodies do nothing here, and what flows or creeps counts as elastic.\n"
      "Example: spoonbill rest assets/models/loaded-handle.json");
  parser.add_option("MODEL", options->model, "A document (.json)").require();
  add_document_output(parser, options->out,
                      "A document with the bodies as they rest, without the loads that bent them");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return rest(*options, console); }};
}

}  // namespace spoonbill
