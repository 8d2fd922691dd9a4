#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/mesh_contact.h"
#include "app/commands/option_values.h"
#include "app/files/mesh_file.h"
#include "app/report/contact_facts.h"
#include "app/report/mesh_facts.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/collision/surfaces/surface_pair_collider.h"
#include "engine/exchange/document.h"

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

Result<Surface> read_body(const std::filesystem::path& file) {
  auto document = read_document(file);
  if (!document) return document.error();
  if (document->scene.bodies[0].shell_thickness_m) {
    return Error{file.string() +
                 ": its body is a shell, and collide takes solid ones; give it a mesh of both faces"};
  }
  if (!document->scene.bodies[0].trims.empty()) {
    return Error{file.string() + ": its body is trimmed, and collide takes closed ones; leave its trims out"};
  }
  Surface surface = std::move(document->scene.bodies[0].surface);
  if (Status closed = check_closed_tube(surface); !closed) {
    return Error{file.string() + ": " + closed.error().message};
  }
  return surface;
}

FactSheet facts_of(const CollideOptions& options) {
  FactSheet facts;
  facts.add("A", options.first.string(), "a", options.first.string());
  if (!options.second.empty()) facts.add("B", options.second.string(), "b", options.second.string());
  return facts;
}

Result<CollisionAnswer> collide_surfaces(const CollideOptions& options) {
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
  return answer_of(result, collider.contacts());
}

Result<CollisionAnswer> collide_with_itself(const CollideOptions& options) {
  const auto body = read_body(options.first);
  if (!body) return body.error();
  const auto grid = make_nested_grid(body->u, body->v, levels);
  if (!grid) return grid.error();
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = true;
  const SelfResult result = collider.collide(body.value(), query);
  return answer_of(result, collider.contacts());
}

// What the mesh is goes to the facts.
Result<CollisionAnswer> collide_with_mesh(const CollideOptions& options, bool mesh_is_a, FactSheet& facts) {
  const auto body = read_body(mesh_is_a ? options.second : options.first);
  if (!body) return body.error();
  const std::filesystem::path& file = mesh_is_a ? options.first : options.second;
  MeshReading reading;
  reading.unit = options.unit;
  auto read = read_mesh_file(file, reading);
  if (!read) return read.error();
  const auto clean = clean_mesh(std::move(read->mesh), file.string());
  if (!clean) return clean.error();
  add_mesh_facts(facts, read->unit, clean.value(), sheet_thickness_m);
  const MeshDistance mesh(clean.value());
  return mesh_is_a ? collide_mesh(mesh, Pose(), placed(body.value(), options.pose), true)
                   : collide_mesh(mesh, options.pose, body.value(), false);
}

Status collide(const CollideOptions& options, Console& console) {
  const bool mesh_is_a = is_mesh_file(options.first), mesh_is_b = is_mesh_file(options.second);
  if (mesh_is_a && mesh_is_b) {
    return Error{options.first.string() + " and " + options.second.string() +
                 " are both meshes; one of them must be a document (.json)"};
  }
  if (options.unit && !mesh_is_a && !mesh_is_b) {
    return Error{options.first.string() + ": a document has its unit; leave --unit out"};
  }
  const bool alone = options.second.empty();
  if (alone && mesh_is_a) {
    return Error{options.first.string() + " is a mesh; name a document (.json) that it is to touch"};
  }
  if (alone && options.posed) return Error{"--pose is where B is; name B, or leave it out"};
  FactSheet facts = facts_of(options);
  const auto answer = alone                    ? collide_with_itself(options)
                      : mesh_is_a || mesh_is_b ? collide_with_mesh(options, mesh_is_a, facts)
                                               : collide_surfaces(options);
  if (!answer) return answer.error();
  add_contact_facts(facts, answer.value());
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_collide(CLI::App& root) {
  auto options = std::make_shared<CollideOptions>();
  CLI::App* parser =
      root.add_subcommand("collide", "Tell whether and how deep two models touch, or one touches itself");
  parser->footer(
      "Found on the B-spline surfaces themselves, to a micrometre: where they touch, how deep, which way A\n"
      "gets out, and the parameters on both; where they do not, the distance and the nearest points.\n"
      "One may be a mesh: cleaned first, its closed parts solid, its open ones plates 1 mm thick.\n"
      "Example: spoonbill collide assets/models/spoon-handle.json assets/models/spoon-handle.json "
      "--pose 0,5mm,0,1,0,0,0");
  parser->add_option("A", options->first, "A document (.json) or a mesh (.obj, .stl, .ply)")->required();
  parser->add_option("B", options->second,
                     "Another, or the same; at least one is a document. Without it, A with itself");
  parser
      ->add_option_function<std::string>(
          "--pose",
          [options](const std::string& text) {
            const auto pose = parse_pose(text);
            if (!pose) throw CLI::ValidationError("--pose", pose.error().message);
            options->pose = pose.value();
            options->posed = true;
          },
          "Where B is: x,y,z, each with its unit (mm, cm, m or in) unless 0, and a turn as a quaternion "
          "w,x,y,z")
      ->type_name("X,Y,Z,QW,QX,QY,QZ");
  parser
      ->add_option_function<std::string>(
          "--unit",
          [options](const std::string& text) {
            const auto unit = parse_unit(text);
            if (!unit) throw CLI::ValidationError("--unit", unit.error().message);
            options->unit = unit.value();
          },
          "Of a mesh's numbers: mm, cm, m or in; mm for .obj and .stl and m for .ply unless told")
      ->type_name("UNIT");
  add_json_option(*parser, options->json);
  return {parser, [options](Console& console) { return collide(*options, console); }};
}

}  // namespace spoonbill
