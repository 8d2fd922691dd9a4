#include "engine/simulation/snapshot_stages.h"

#include <optional>
#include <variant>

#include "engine/collision/meshes/mesh_distance.h"
#include "engine/scene/tool.h"

namespace spoonbill {
namespace {

// A cache of stages is cleared when it has this number of entries. A session rarely needs as many.
constexpr std::size_t max_cached_structures = 32;
// Represents the tool in the keys of pair_stages_, in place of a fingerprint of knots.
constexpr std::uint64_t tool_structure = 0;

std::optional<Surface> make_surface_of(const SurfaceSnapshot& snapshot) {
  ControlNet net(snapshot.u.control_point_count(), snapshot.v.control_point_count());
  if (snapshot.x.size() != net.size() || snapshot.y.size() != net.size() || snapshot.z.size() != net.size()) {
    return std::nullopt;
  }
  net.x.assign(snapshot.x.begin(), snapshot.x.end());
  net.y.assign(snapshot.y.begin(), snapshot.y.end());
  net.z.assign(snapshot.z.begin(), snapshot.z.end());
  Result<Surface> surface = make_surface(snapshot.u, snapshot.v, std::move(net));
  if (!surface.ok()) return std::nullopt;
  return std::move(surface).value();
}

// Returns true if the tool is soft, and therefore one of the snapshot's bodies, or if its body is not known.
bool is_soft_body(const ToolSnapshot& tool) {
  return tool.kind == ToolKind::solid && (!tool.body || tool.body->soft);
}

// Returns the cached stages of a key. Makes them with `make` if they are missing; returns null if `make`
// fails.
template <class Key, class Stages, class Make>
Stages* find_or_make(std::map<Key, Stages>& all, const Key& key, const Make& make) {
  const auto found = all.find(key);
  if (found != all.end()) return &found->second;
  if (all.size() >= max_cached_structures) all.clear();
  Result<Stages> made = make();
  if (!made.ok()) return nullptr;
  return &all.emplace(key, std::move(made).value()).first->second;
}

}  // namespace

ContactStages SnapshotStages::find(const Snapshot& snapshot) {
  update_solid(snapshot.tool);
  ContactStages stages;
  std::vector<Surface> surfaces;
  std::vector<StructuredSurface> bodies;
  surfaces.reserve(snapshot.bodies.size());
  for (const BodySnapshot& body : snapshot.bodies) {
    if (body.is_mesh()) continue;
    std::optional<Surface> surface = make_surface_of(body.surface);
    if (!surface) continue;
    surfaces.push_back(*std::move(surface));
    const bool closed = !(body.shell_thickness_m > 0.0) && !body.surface.trim;
    bodies.push_back({&surfaces.back(), body.surface.structure, closed, body.surface.trim});
    add_hull(surfaces.back().net, stages);
  }
  if (!is_soft_body(snapshot.tool)) {
    const Pose& pose = snapshot.tool.proxy;
    const Eigen::Matrix3d turn = pose.orientation.normalized().toRotationMatrix();
    add_tool(snapshot, pose, turn, bodies, stages);
    if (snapshot.symmetric) {
      const Vector3& normal = snapshot.symmetry.normal;
      const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
      const Pose& mirrored = snapshot.mirrored_proxy;
      add_tool(snapshot, mirrored, mirrored.orientation.normalized().toRotationMatrix() * reflection, bodies,
               stages);
    }
  }
  for (std::size_t a = 0; a < bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < bodies.size(); ++b) add_pair(bodies[a], bodies[b], stages);
  }
  return stages;
}

void SnapshotStages::update_solid(const ToolSnapshot& tool) {
  const std::shared_ptr<const ToolBody> body = tool.kind == ToolKind::solid ? tool.body : nullptr;
  if (solid_.made_from == body) return;
  solid_ = {body, nullptr, nullptr};
  std::erase_if(pair_stages_, [](const auto& entry) { return entry.first.second == tool_structure; });
  if (!body || body->soft) return;
  if (const auto* shape = std::get_if<ImplicitShape>(&body->solid)) {
    solid_.distance = make_signed_distance(*shape);
  } else if (const auto* mesh = std::get_if<MeshSolid>(&body->solid)) {
    solid_.distance = std::make_shared<MeshDistance>(mesh->mesh);
  } else {
    solid_.surface = std::make_shared<Surface>(std::get<SurfaceSolid>(body->solid).surface);
  }
}

void SnapshotStages::add_tool(const Snapshot& snapshot, const Pose& pose, const Eigen::Matrix3d& turn,
                              const std::vector<StructuredSurface>& bodies, ContactStages& stages) {
  if (!pose.position_m.allFinite() || !turn.allFinite()) return;
  if (solid_.surface) {
    Surface placed = *solid_.surface;
    place(solid_.surface->net, turn, pose.position_m, placed.net);
    add_hull(placed.net, stages);
    const bool outward = turn.determinant() > 0.0;
    for (const StructuredSurface& body : bodies) add_pair(body, {&placed, tool_structure, outward}, stages);
    return;
  }
  const ToolShape shape = solid_.distance ? ToolShape::solid(*solid_.distance, pose.position_m, turn)
                                          : ToolShape::sphere(pose.position_m, snapshot.tool.radius_m);
  for (const StructuredSurface& body : bodies) {
    const Surface& surface = *body.surface;
    ToolStages* const tool_stages =
        find_or_make(tool_stages_, body.structure, [&] { return ToolStages::make(surface.u, surface.v); });
    if (tool_stages != nullptr)
      tool_stages->add(surface, shape, stage_margin_m, body.closed, stages, body.trim);
  }
}

void SnapshotStages::add_pair(const StructuredSurface& first, const StructuredSurface& second,
                              ContactStages& stages) {
  const std::pair structures{first.structure, second.structure};
  PairStages* const pair_stages = find_or_make(
      pair_stages_, structures, [&] { return PairStages::make(*first.surface, *second.surface); });
  if (pair_stages == nullptr) return;
  pair_stages->add(*first.surface, *second.surface, stage_margin_m, first.closed, second.closed, stages);
}

}  // namespace spoonbill
