#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/body_collision.h"
#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/mesh_contact.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/mesh_file.h"
#include "app/report/contact_facts.h"
#include "app/report/mesh_facts.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/rigid/body_tree.h"
#include "engine/collision/rigid/mesh_pair.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/collision/surfaces/surface_pair_collider.h"
#include "engine/exchange/document.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

struct CollideOptions {
  std::filesystem::path first, second;
  Pose pose;
  bool posed = false;
  std::optional<LengthUnit> unit;
  bool json = false;
};

// Cells a quarter of an element wide: regions are told that closely.
constexpr int levels = 2;

// One side of a collision: the bodies of a document, or a mesh.
struct Model {
  std::vector<Surface> bodies;
  std::vector<std::string> names;  // of the bodies; empty where there is one
  std::optional<CleanMesh> mesh;
};

// A surface that collide takes: solid, whole and closed. `whose` begins an Error's message.
Result<Surface> closed_surface_of(Body& body, const std::string& whose) {
  if (body.shell_thickness_m) {
    return Error{whose + "its body is a shell, and collide takes solid ones; give it a mesh of both faces"};
  }
  if (!body.trims.empty()) {
    return Error{whose + "its body is trimmed, and collide takes closed ones; leave its trims out"};
  }
  if (Status closed = check_closed_tube(body.surface); !closed) return Error{whose + closed.error().message};
  return std::move(body.surface);
}

Result<Model> read_bodies(const std::filesystem::path& file) {
  auto document = read_document(file);
  if (!document) return document.error();
  std::vector<Body>& bodies = document->scene.bodies;
  Model model;
  for (Body& body : bodies) {
    const bool alone = bodies.size() == 1;
    auto surface =
        closed_surface_of(body, file.string() + ": " + (alone ? "" : "body \"" + body.name + "\": "));
    if (!surface) return surface.error();
    model.bodies.push_back(std::move(surface).value());
    if (!alone) model.names.push_back(body.name);
  }
  return model;
}

// How the facts name a mesh.
struct MeshLabel {
  const char* field;
  const char* whose;
};

// Reads and cleans a mesh, and adds what was cleaned to the facts.
Result<Model> read_mesh(const std::filesystem::path& file, const std::optional<LengthUnit>& unit,
                        const MeshLabel& label, FactSheet& facts) {
  MeshReading reading;
  reading.unit = unit;
  auto read = read_mesh_file(file, reading);
  if (!read) return read.error();
  auto clean = clean_mesh(std::move(read->mesh), file.string());
  if (!clean) return clean.error();
  add_mesh_facts(facts, read->unit, clean.value(), sheet_thickness_m, label.field, label.whose);
  Model model;
  model.mesh = std::move(clean).value();
  return model;
}

FactSheet facts_of(const CollideOptions& options) {
  FactSheet facts;
  facts.add("A", options.first.string(), "a", options.first.string());
  if (!options.second.empty()) facts.add("B", options.second.string(), "b", options.second.string());
  return facts;
}

Result<CollisionAnswer> collide_surfaces(const Surface& a, const Surface& b, double reach_m,
                                         const std::string& files) {
  const auto grid_a = make_nested_grid(a.u, a.v, levels), grid_b = make_nested_grid(b.u, b.v, levels);
  if (!grid_a) return grid_a.error();
  if (!grid_b) return grid_b.error();

  SurfacePairCollider collider(grid_a.value(), grid_b.value());
  PairQuery query;
  query.first_closed = query.second_closed = true;
  query.reach_m = reach_m;
  const PairResult result = collider.collide(a, b, query);
  if (result.overflow && !result.touching) {
    return Error{"these surfaces come near each other in more places than can be searched: " + files +
                 "; give them fewer control points or another --pose"};
  }
  return answer_of(result, collider.contacts());
}

Result<CollisionAnswer> collide_with_itself(const Surface& body) {
  const auto grid = make_nested_grid(body.u, body.v, levels);
  if (!grid) return grid.error();
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = true;
  const SelfResult result = collider.collide(body, query);
  return answer_of(result, collider.contacts());
}

std::vector<Box> boxes_of(const std::vector<Surface>& bodies) {
  std::vector<Box> boxes;
  boxes.reserve(bodies.size());
  for (const Surface& body : bodies) boxes.push_back(bounding_box(body.net));
  return boxes;
}

// Each body with itself, and with the others.
Result<CollisionAnswer> collide_alone(const Model& model, const std::string& file) {
  BodiesAnswer together(model.names, model.names);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    auto answer = collide_with_itself(model.bodies[b]);
    if (!answer) return answer.error();
    together.add(b, b, std::move(answer).value());
  }
  for (const auto& [a, b] : BodyTree(boxes_of(model.bodies)).near_pairs()) {
    auto answer = collide_surfaces(model.bodies[a], model.bodies[b], 0.0, file);
    if (!answer) return answer.error();
    if (answer->touching) together.add(a, b, std::move(answer).value());
  }
  return together.answer();
}

Result<CollisionAnswer> collide_documents(const Model& a, const Model& b, const CollideOptions& options) {
  std::vector<Surface> placed_b;
  for (const Surface& body : b.bodies) placed_b.push_back(placed(body, options.pose));
  const std::string files = options.first.string() + " and " + options.second.string();
  return collide_bodies({boxes_of(a.bodies), a.names}, {boxes_of(placed_b), b.names},
                        [&](std::size_t i, std::size_t j, double reach_m) {
                          return collide_surfaces(a.bodies[i], placed_b[j], reach_m, files);
                        });
}

// Either may be the mesh; the pose moves B.
Result<CollisionAnswer> collide_with_mesh(const Model& a, const Model& b, const Pose& pose) {
  const bool mesh_is_a = a.mesh.has_value();
  const MeshDistance mesh(mesh_is_a ? *a.mesh : *b.mesh);
  const Pose mesh_pose = mesh_is_a ? Pose() : pose;
  std::vector<Surface> bodies = mesh_is_a ? b.bodies : a.bodies;
  for (Surface& body : bodies) {
    if (mesh_is_a) body = placed(std::move(body), pose);
  }
  const BodyBoxes of_mesh{{box_about(mesh.bounds(), mesh_pose)}, {}};
  const BodyBoxes of_bodies{boxes_of(bodies), mesh_is_a ? b.names : a.names};
  return collide_bodies(mesh_is_a ? of_mesh : of_bodies, mesh_is_a ? of_bodies : of_mesh,
                        [&](std::size_t i, std::size_t j, double) {
                          return collide_mesh(mesh, mesh_pose, bodies[mesh_is_a ? j : i], mesh_is_a);
                        });
}

Status check_use(const CollideOptions& options, bool mesh_is_a, bool mesh_is_b) {
  if (options.unit && !mesh_is_a && !mesh_is_b) {
    return Error{options.first.string() + ": a document has its unit; leave --unit out"};
  }
  if (!options.second.empty()) return {};
  if (mesh_is_a) {
    return Error{options.first.string() + " is a mesh; name a document or a mesh that it is to touch"};
  }
  if (options.posed) return Error{"--pose is where B is; name B, or leave it out"};
  return {};
}

Status collide(const CollideOptions& options, Console& console) {
  const bool mesh_is_a = is_mesh(format_from_name(options.first)), mesh_is_b = is_mesh(format_from_name(options.second));
  if (Status use = check_use(options, mesh_is_a, mesh_is_b); !use) return use.error();
  const bool both = mesh_is_a && mesh_is_b;
  FactSheet facts = facts_of(options);
  const auto read = [&](const std::filesystem::path& file, bool is_mesh, const MeshLabel& label) {
    return is_mesh ? read_mesh(file, options.unit, both ? label : MeshLabel{"mesh", ""}, facts)
                   : read_bodies(file);
  };
  const auto a = read(options.first, mesh_is_a, {"mesh_a", " of A"});
  if (!a) return a.error();
  const bool alone = options.second.empty();
  const auto b = alone ? Result<Model>(Model()) : read(options.second, mesh_is_b, {"mesh_b", " of B"});
  if (!b) return b.error();
  const auto answer = alone  ? collide_alone(a.value(), options.first.string())
                      : both ? Result(answer_of(collide_meshes(*a->mesh, *b->mesh, options.pose)))
                      : mesh_is_a || mesh_is_b ? collide_with_mesh(a.value(), b.value(), options.pose)
                                               : collide_documents(a.value(), b.value(), options);
  if (!answer) return answer.error();
  add_contact_facts(facts, answer.value());
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_collide(OptionSet root) {
  auto options = std::make_shared<CollideOptions>();
  const OptionSet parser =
      root.add_command("collide", "Tell whether and how deep two models touch, or one touches itself");
  parser.set_footer(
      "Found on the B-spline surfaces themselves, to a micrometre: where they touch, how deep, which way A\n"
      "gets out, and the parameters on both; where they do not, the distance and the nearest points.\n"
      "A mesh is cleaned first, its closed parts solid, its open ones plates 1 mm thick. Two meshes are as "
      "deep\n"
      "as the deepest of their corners and edges. Of a document all bodies count, also with each other.\n"
      "Example: spoonbill collide assets/models/spoon-handle.json assets/models/spoon-handle.json "
      "--pose 0,5mm,0,1,0,0,0");
  parser.add_option("A", options->first, "A document (.json) or a mesh (.obj, .stl, .ply)").require();
  parser.add_option("B", options->second,
                    "Another, or the same. Without it, A with itself, which must be a document");
  parser
      .add_parsed(
          "--pose",
          [options](const std::string& text) -> Status {
            const auto pose = parse_pose(text);
            if (!pose) return pose.error();
            options->pose = pose.value();
            options->posed = true;
            return {};
          },
          "Where B is: x,y,z, each with its unit (mm, cm, m or in) unless 0, and a turn as a quaternion "
          "w,x,y,z")
      .show_as("X,Y,Z,QW,QX,QY,QZ");
  parser
      .add_parsed(
          "--unit",
          [options](const std::string& text) -> Status {
            const auto unit = parse_unit(text);
            if (!unit) return unit.error();
            options->unit = unit.value();
            return {};
          },
          "Of the numbers of meshes: mm, cm, m or in; mm for .obj and .stl and m for .ply unless told")
      .show_as("UNIT");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return collide(*options, console); }};
}

}  // namespace spoonbill
