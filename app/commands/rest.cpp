#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/files/documents.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/simulation/rest_shape.h"

namespace spoonbill {
namespace {

struct RestOptions {
  OutputOptions how;
  std::filesystem::path model, out;
  bool json = false;
};

void add_elastic_note(const Material& material, FactSheet& facts) {
  if (is_linear_elastic(material)) return;
  facts.add("  Material", material.name + ", treated as elastic", "", nullptr);
}

void add_rest_body(FactSheet& facts, const Body& body, const RestShape& shape, Json& list) {
  const auto furthest = static_cast<std::size_t>(shape.furthest_node);
  const Vector3 displacement = shape.result.displacement_m[furthest], position = shape.mesh.nodes[furthest];
  facts.add("Body", body.name, "", nullptr);
  facts.add("  Fixed nodes",
            std::to_string(shape.fixed_nodes) + " of " + std::to_string(shape.mesh.node_count()), "",
            nullptr);
  const bool nothing_moves = shape.result.is_fixed_everywhere && displacement.isZero(0.0);
  facts.add("  Displaced",
            nothing_moves
                ? "everything is fixed: nothing moves"
                : "at most " + short_length_text(displacement.norm()) + ", at " + position_text(position),
            "", nullptr);
  facts.add("  Loads", newtons_text(shape.load_n.norm()) + " together", "", nullptr);
  facts.add("  Reactions", newtons_text(shape.reaction_n.norm()) + " together", "", nullptr);
  facts.add("  Strain",
            nothing_moves ? "none"
                          : "at most " + percent_text(std::abs(shape.largest_strain)) +
                                (shape.largest_strain < 0.0 ? " compression" : " tension") + ", at " +
                                position_text(shape.largest_strain_position_m),
            "", nullptr);
  add_elastic_note(body.material, facts);
  for (const MaterialRegion& region : body.regions) {
    if (region.material) add_elastic_note(*region.material, facts);
  }
  list.push_back({{"name", body.name},
                  {"nodes", shape.mesh.node_count()},
                  {"held_nodes", shape.fixed_nodes},
                  {"fixed_everywhere", shape.result.is_fixed_everywhere},
                  {"largest_displacement_m", displacement.norm()},
                  {"displacement_m", components_json(displacement)},
                  {"displaced_m", components_json(position)},
                  {"load_n", components_json(shape.load_n)},
                  {"reaction_n", components_json(shape.reaction_n)},
                  {"largest_strain", shape.largest_strain},
                  {"strained_m", components_json(shape.largest_strain_position_m)},
                  {"energy_j", shape.result.energy_j},
                  {"newton_steps", shape.result.newton_steps}});
}

// Removes gravity, loads and support motions. The bodies are stored in their bent shape, and these influences
// would bend them a second time.
void remove_loads(Scene& scene) {
  scene.sculpting.gravity_m_per_s2.setZero();
  for (Body& body : scene.bodies) {
    body.loads.clear();
    for (Support& support : body.supports) support.motion.reset();
  }
}

Status rest(const RestOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  auto document = read_document_file(options.model);
  if (!document) return document.error();
  Scene& scene = document->scene;
  if (Status few = check_body_count(scene); !few) return few.error().in(options.model.string());
  FactSheet facts;
  facts.add("File", options.model.string(), "file", options.model.string());
  Json list = Json::array();
  std::vector<Surface> bent;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.kind != BodyKind::deformable) {
      facts.add("Body", body.name + ", " + body_kind_names[static_cast<std::size_t>(body.kind)], "", nullptr);
      bent.push_back(body.surface);
      continue;
    }
    const auto shape =
        CancellableJob(console, "Bending " + body.name, options.out).run([&](const Progress& progress) {
          return compute_rest_shape(scene, static_cast<int>(b), progress);
        });
    if (!shape && shape.error().code == ErrorCode::cancelled) return shape.error();
    if (!shape) return shape.error().in("body \"" + body.name + "\"").in(options.model.string());
    add_rest_body(facts, body, shape.value(), list);
    bent.push_back(shape->surface);
  }
  facts.add("", "", "bodies", list);
  if (!options.out.empty()) {
    const InterruptWatch until_written;
    for (std::size_t b = 0; b < bent.size(); ++b) scene.bodies[b].surface = std::move(bent[b]);
    remove_loads(scene);
    if (Status written = write_document(document.value(), options.out, options.how); !written) return written;
  }
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_rest(OptionSet root) {
  auto options = std::make_shared<RestOptions>();
  const OptionSet parser = root.add_command("rest", "Compute how bodies bend under gravity and their loads");
  parser.set_footer(
      "Computes the equilibrium of each body alone under the document's gravity, its loads and its\n"
      "supports, with the stiffness of its material. Reports displacement, reactions of the supports and\n"
      "strain. The ground and other bodies have no effect. Materials that flow or creep are treated as\n"
      "elastic.\n"
      "Example: spoonbill rest assets/models/loaded-handle.json");
  parser.add_option("MODEL", options->model, "Document (.json)").require();
  add_force_option(parser, options->how);
  add_document_output(parser, options->out,
                      "Document to write (.json), with the bent bodies and without the loads; default: none");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return rest(*options, console); }};
}

}  // namespace spoonbill
