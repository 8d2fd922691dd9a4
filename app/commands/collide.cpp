#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/files/scan_file.h"
#include "app/report/contact_facts.h"
#include "engine/base/geometry.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/rigid/body_tree.h"
#include "engine/collision/rigid/mesh_pair.h"
#include "engine/collision/solids/signed_distance.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/collision/surfaces/surface_pair_collider.h"
#include "engine/exchange/document.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

struct CollideOptions {
  std::filesystem::path first, second;
  Pose pose;
  bool has_pose = false;
  std::optional<LengthUnit> unit;
  bool json = false;
};

// Number of times that each element is halved along u and along v. Contact regions are resolved to a quarter
// of an element's side.
constexpr int collision_levels = 2;

// One side of a collision: the bodies of a document, or a mesh.
struct CollisionModel {
  std::vector<Surface> bodies;
  std::vector<std::string> names;  // names of the bodies; empty for a single body
  std::optional<CleanMesh> mesh;
};

// Bounding boxes and names of a model's bodies, for the search for close pairs.
struct BodyBoxes {
  std::vector<Box> boxes;          // bounding box of each body; at least one
  std::vector<std::string> names;  // name of each body; empty for a single body
};

// Enlarges the boxes by the touch tolerance, so that the boxes of bodies that touch overlap.
std::vector<Box> enlarge_boxes(std::vector<Box> boxes) {
  for (Box& box : boxes) box = {box.low.array() - touch_tolerance_m, box.high.array() + touch_tolerance_m};
  return boxes;
}

// Returns the axis-aligned box around a box that is moved to the pose.
Box pose_box(const Box& box, const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.orientation.normalized().toRotationMatrix();
  const Vector3 centre = rotation * (0.5 * (box.low + box.high)) + pose.position_m;
  const Vector3 half = rotation.cwiseAbs() * (0.5 * (box.high - box.low));
  return {centre - half, centre + half};
}

// Combines the answers for the pairs of bodies of two models. The models touch if any pair touches.
// Otherwise, their distance is that of the nearest pair.
class CombinedAnswer {
 public:
  CombinedAnswer(std::vector<std::string> names_a, std::vector<std::string> names_b)
      : names_a_(std::move(names_a)), names_b_(std::move(names_b)) {
    answer_.distance_m = std::numeric_limits<double>::infinity();
  }

  void add(std::size_t a, std::size_t b, CollisionAnswer answer) {
    const auto name_sides = [&](ContactSide& side_a, ContactSide& side_b) {
      side_a.body = find_name(names_a_, a);
      side_b.body = find_name(names_b_, b);
    };
    answer_.touching |= answer.touching;
    answer_.contained |= answer.contained;
    answer_.complete &= answer.complete;
    if (!answer.touching && answer.distance_m < answer_.distance_m) {
      name_sides(answer.nearest_a, answer.nearest_b);
      answer_.distance_m = answer.distance_m;
      answer_.nearest_a = std::move(answer.nearest_a);
      answer_.nearest_b = std::move(answer.nearest_b);
    }
    for (ModelContact& contact : answer.contacts) {
      name_sides(contact.a, contact.b);
      answer_.contacts.push_back(std::move(contact));
    }
  }
  const CollisionAnswer& answer() const { return answer_; }

 private:
  static std::string find_name(const std::vector<std::string>& names, std::size_t body) {
    return names.empty() ? std::string() : names[body];
  }

  std::vector<std::string> names_a_, names_b_;
  CollisionAnswer answer_;
};

// Collides body `a` of model A with body `b` of model B. If they do not touch, their distance must be exact
// up to `reach_m`; a larger distance may be returned as infinite.
using PairCollision = std::function<Result<CollisionAnswer>(std::size_t a, std::size_t b, double reach_m)>;

// Collides the close pairs of bodies of two models, or finds the nearest pair if none touches. The first
// error of a pair is returned.
Result<CollisionAnswer> collide_bodies(const BodyBoxes& a, const BodyBoxes& b, const PairCollision& collide) {
  const BodyTree bodies(enlarge_boxes(a.boxes)), others(enlarge_boxes(b.boxes));
  CombinedAnswer combined(a.names, b.names);
  std::set<BodyPair> tested;
  std::optional<Error> error;
  const auto add = [&](std::size_t i, std::size_t j) {
    auto answer = collide(i, j, combined.answer().distance_m);
    if (!answer) {
      error = answer.error();
      return;
    }
    tested.emplace(i, j);
    combined.add(i, j, std::move(answer).value());
  };
  for (const auto& [i, j] : bodies.near_pairs(others)) {
    if (!error) add(i, j);
  }
  if (!error && !combined.answer().touching) {
    bodies.find_nearest(others, [&](std::size_t i, std::size_t j) {
      if (!error && !tested.contains({i, j})) add(i, j);
      return error ? 0.0 : combined.answer().distance_m;
    });
  }
  if (error) return *error;
  return combined.answer();
}

ContactSide mesh_side(const ToolShape& tool, const Vector3& from) {
  const DistanceSample sample = tool.at(from);
  return {from - sample.distance_m * sample.gradient, {}, {}};
}

ContactSide surface_side(const SurfaceContact& contact) {
  return {contact.point_m, SurfaceParameters{contact.u, contact.v, {}}, {}};
}

// Returns the contact of a mesh with a surface. Its normal is parallel to the normal of the surface.
ModelContact make_contact(const ToolShape& tool, const SurfaceContact& at, bool mesh_is_a) {
  ModelContact contact{surface_side(at), mesh_side(tool, at.point_m), -at.normal, at.depth_m, at.tangent_u,
                       at.tangent_v};
  if (!mesh_is_a) return contact;
  std::swap(contact.a, contact.b);
  contact.normal = at.normal;
  return contact;
}

// Collides a mesh in its pose with the closed surface of a body. `mesh_is_a` is true if the mesh is side A of
// the answer. The depth of a contact is how deep the surface is in the mesh. If the whole mesh is inside the
// body, it is how deep the mesh is in the body.
Result<CollisionAnswer> collide_mesh(const SignedDistance& mesh, const Pose& mesh_pose,
                                     const Surface& surface, bool mesh_is_a) {
  const auto grid = make_nested_grid(surface.u, surface.v, collision_levels);
  if (!grid) return grid.error();
  SurfaceCollider collider(grid.value());
  const ToolShape tool = ToolShape::solid(mesh, mesh_pose);
  const CollisionResult result = collider.collide(surface, tool, 0.0, true);

  CollisionAnswer answer;
  answer.touching = result.found;
  answer.complete = !result.overflow;
  const ModelContact nearest = make_contact(tool, result.nearest, mesh_is_a);
  answer.nearest_a = nearest.a;
  answer.nearest_b = nearest.b;
  answer.distance_m = std::max(-result.nearest.depth_m, 0.0);
  if (!result.found) return answer;

  for (const ToolContactRegion& region : collider.find_contact_regions(tool)) {
    answer.contacts.push_back(make_contact(tool, region.deepest, mesh_is_a));
    ContactSide& side = mesh_is_a ? answer.contacts.back().b : answer.contacts.back().a;
    side.parameters->range = region.range;
  }
  answer.complete = answer.complete && !collider.regions_overflow();
  // If the mesh touches the body but has no contact region, the mesh is inside the body. If there are contact
  // regions, the first contact gets the largest depth, which `nearest` has.
  answer.contained = answer.contacts.empty();
  if (answer.contained) {
    answer.contacts.push_back(nearest);
  } else {
    answer.contacts.front().depth_m = std::max(answer.contacts.front().depth_m, nearest.depth_m);
  }
  return answer;
}

// Returns the surface of the body, which must be a closed solid without trims. `context` names the body in
// errors.
Result<Surface> extract_closed_surface(Body& body, const std::string& context) {
  if (body.shell_thickness_m) {
    return Error{ErrorCode::unsupported,
                 context +
                     ": the body is a shell, and collide needs solid bodies; export a mesh of it "
                     "with `spoonbill convert` and collide the mesh instead"};
  }
  if (!body.trims.empty()) {
    return Error{ErrorCode::unsupported,
                 context + ": the body is trimmed, and collide needs closed bodies; remove its trims"};
  }
  if (Status closed = check_closed_tube(body.surface); !closed) return closed.error().in(context);
  return std::move(body.surface);
}

Result<CollisionModel> read_bodies(const std::filesystem::path& file) {
  auto document = read_document(file);
  if (!document) return document.error();
  std::vector<Body>& bodies = document->scene.bodies;
  if (Status surfaces = check_surfaces(bodies, file); !surfaces) return surfaces.error();
  CollisionModel model;
  for (Body& body : bodies) {
    const bool alone = bodies.size() == 1;
    auto surface =
        extract_closed_surface(body, file.string() + (alone ? "" : ": body \"" + body.name + "\""));
    if (!surface) return surface.error();
    model.bodies.push_back(std::move(surface).value());
    if (!alone) model.names.push_back(body.name);
  }
  return model;
}

// Names for the facts of a mesh: `field` is its member in the JSON, `suffix` ends the labels shown to people.
struct MeshLabel {
  const char* field;
  const char* suffix;
};

// Reads and cleans a mesh, and adds its facts.
Result<CollisionModel> read_mesh(const std::filesystem::path& file, const std::optional<LengthUnit>& unit,
                                 const MeshLabel& label, FactSheet& facts) {
  MeshReading reading;
  reading.unit = unit;
  auto read = read_mesh_file(file, reading);
  if (!read) return read.error();
  auto clean = clean_mesh(std::move(read->mesh), file.string());
  if (!clean) return clean.error();
  add_mesh_facts(facts, read->unit, clean.value(), sheet_thickness_m, label.field, label.suffix);
  CollisionModel model;
  model.mesh = std::move(clean).value();
  return model;
}

FactSheet begin_facts(const CollideOptions& options) {
  FactSheet facts;
  facts.add("A", options.first.string(), "a", options.first.string());
  if (!options.second.empty()) facts.add("B", options.second.string(), "b", options.second.string());
  return facts;
}

Result<CollisionAnswer> collide_surfaces(const Surface& a, const Surface& b, double reach_m,
                                         const std::string& files) {
  const auto grid_a = make_nested_grid(a.u, a.v, collision_levels),
             grid_b = make_nested_grid(b.u, b.v, collision_levels);
  if (!grid_a) return grid_a.error();
  if (!grid_b) return grid_b.error();

  SurfacePairCollider collider(grid_a.value(), grid_b.value());
  PairQuery query;
  query.first_closed = query.second_closed = true;
  query.reach_m = reach_m;
  const PairResult result = collider.collide(a, b, query);
  if (result.overflow && !result.touching) {
    return Error{ErrorCode::too_many, "the surfaces are close at more points than can be searched: " + files +
                                          "; reduce their control points or change --pose"};
  }
  return make_answer(result, collider.contacts());
}

Result<CollisionAnswer> collide_with_itself(const Surface& body) {
  const auto grid = make_nested_grid(body.u, body.v, collision_levels);
  if (!grid) return grid.error();
  SurfaceSelfCollider collider(grid.value());
  SelfQuery query;
  query.closed = true;
  const SelfResult result = collider.collide(body, query);
  return make_answer(result, collider.contacts());
}

std::vector<Box> boxes_of(const std::vector<Surface>& bodies) {
  std::vector<Box> boxes;
  boxes.reserve(bodies.size());
  for (const Surface& body : bodies) boxes.push_back(bounding_box(body.net));
  return boxes;
}

// Collides each body of a document with itself and with the other bodies.
Result<CollisionAnswer> collide_document_with_itself(const CollisionModel& model, const std::string& file) {
  CombinedAnswer combined(model.names, model.names);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    auto answer = collide_with_itself(model.bodies[b]);
    if (!answer) return answer.error();
    combined.add(b, b, std::move(answer).value());
  }
  for (const auto& [a, b] : BodyTree(boxes_of(model.bodies)).near_pairs()) {
    auto answer = collide_surfaces(model.bodies[a], model.bodies[b], 0.0, file);
    if (!answer) return answer.error();
    if (answer->touching) combined.add(a, b, std::move(answer).value());
  }
  return combined.answer();
}

Result<CollisionAnswer> collide_documents(const CollisionModel& a, const CollisionModel& b,
                                          const CollideOptions& options) {
  std::vector<Surface> placed_b;
  for (const Surface& body : b.bodies) placed_b.push_back(placed(body, options.pose));
  const std::string files = options.first.string() + " and " + options.second.string();
  return collide_bodies({boxes_of(a.bodies), a.names}, {boxes_of(placed_b), b.names},
                        [&](std::size_t i, std::size_t j, double reach_m) {
                          return collide_surfaces(a.bodies[i], placed_b[j], reach_m, files);
                        });
}

// Collides a mesh with the bodies of a document. Model A may be the mesh or the document; the pose moves B.
Result<CollisionAnswer> collide_with_mesh(const CollisionModel& a, const CollisionModel& b,
                                          const Pose& pose) {
  const bool mesh_is_a = a.mesh.has_value();
  const MeshDistance mesh(mesh_is_a ? *a.mesh : *b.mesh);
  const Pose mesh_pose = mesh_is_a ? Pose() : pose;
  std::vector<Surface> bodies = mesh_is_a ? b.bodies : a.bodies;
  for (Surface& body : bodies) {
    if (mesh_is_a) body = placed(std::move(body), pose);
  }
  const BodyBoxes of_mesh{{pose_box(mesh.bounds(), mesh_pose)}, {}};
  const BodyBoxes of_bodies{boxes_of(bodies), mesh_is_a ? b.names : a.names};
  return collide_bodies(mesh_is_a ? of_mesh : of_bodies, mesh_is_a ? of_bodies : of_mesh,
                        [&](std::size_t i, std::size_t j, double) {
                          return collide_mesh(mesh, mesh_pose, bodies[mesh_is_a ? j : i], mesh_is_a);
                        });
}

Status check_use(const CollideOptions& options, bool mesh_is_a, bool mesh_is_b) {
  if (options.unit && !mesh_is_a && !mesh_is_b) {
    return Error{ErrorCode::inconsistent,
                 options.first.string() + ": a document has its own unit; remove --unit", "--unit"};
  }
  if (!options.second.empty()) return {};
  if (mesh_is_a) {
    return Error{ErrorCode::missing,
                 options.first.string() + ": is a mesh and needs a second model; add a document or a mesh",
                 "B"};
  }
  if (options.has_pose)
    return Error{ErrorCode::inconsistent, "--pose is the pose of B; add B, or remove --pose", "--pose"};
  return {};
}

Status collide_models(const CollideOptions& options, Console& console) {
  const bool mesh_is_a = is_mesh(format_from_name(options.first)),
             mesh_is_b = is_mesh(format_from_name(options.second));
  if (Status use = check_use(options, mesh_is_a, mesh_is_b); !use) return use.error();
  const bool both = mesh_is_a && mesh_is_b;
  FactSheet facts = begin_facts(options);
  const auto read = [&](const std::filesystem::path& file, bool is_mesh, const MeshLabel& label) {
    return is_mesh ? read_mesh(file, options.unit, both ? label : MeshLabel{"mesh", ""}, facts)
                   : read_bodies(file);
  };
  const auto a = read(options.first, mesh_is_a, {"mesh_a", " of A"});
  if (!a) return a.error();
  const bool alone = options.second.empty();
  const auto b =
      alone ? Result<CollisionModel>(CollisionModel()) : read(options.second, mesh_is_b, {"mesh_b", " of B"});
  if (!b) return b.error();
  const auto answer = alone  ? collide_document_with_itself(a.value(), options.first.string())
                      : both ? Result(make_answer(collide_meshes(*a->mesh, *b->mesh, options.pose)))
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
      root.add_command("collide", "Find contacts between two models, or of one with itself");
  parser.set_footer(
      "Uses the B-spline surfaces themselves, accurate to a micrometre. If the models touch, reports the\n"
      "position, the depth, the direction in which A separates, and the parameters on both; otherwise the\n"
      "distance and the nearest points. A mesh is cleaned first; its closed parts are solid, its open\n"
      "parts are plates 1 mm thick. The depth of two meshes is that of their deepest corner or edge. All\n"
      "bodies of a document are tested; a document without B is tested against itself, body by body.\n"
      "Example: spoonbill collide assets/models/spoon-handle.json assets/models/spoon-handle.json "
      "--pose 0,5mm,0,1,0,0,0");
  parser.add_option("A", options->first, "Document (.json) or mesh (.obj, .stl, .ply)").require();
  parser.add_option(
      "B", options->second,
      "Second model, which may be the same file; default: none, a document is tested against itself");
  parser
      .add_parsed(
          "--pose",
          [options](const std::string& text) -> Status {
            const auto pose = parse_pose(text);
            if (!pose) return pose.error();
            options->pose = pose.value();
            options->has_pose = true;
            return {};
          },
          "Pose of B: x,y,z, each with its unit (mm, cm, m or in) unless 0, and the rotation as a quaternion "
          "w,x,y,z; default: 0,0,0,1,0,0,0")
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
          "Unit of the meshes' numbers: mm, cm, m or in; default: mm for .obj and .stl, m for .ply")
      .show_as("UNIT");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return collide_models(*options, console); }};
}

}  // namespace spoonbill
