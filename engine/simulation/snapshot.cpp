#include "engine/simulation/snapshot.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/simulation/simulation_state.h"

namespace spoonbill {
namespace {

void add_to_hash(const KnotVector& direction, StateHash& hash) {
  hash.add(static_cast<std::uint64_t>(direction.degree()) << 1 | (direction.is_periodic() ? 1u : 0u));
  for (const double knot : direction.knots()) hash.add(knot);
}

// Returns a hash of the knots. A counter of changes would not distinguish the surfaces of different sessions.
std::uint64_t fingerprint_structure(const Surface& surface) {
  StateHash hash;
  add_to_hash(surface.u, hash);
  add_to_hash(surface.v, hash);
  return hash.value();
}

template <class Real>
void reserve(KnotVector& u, KnotVector& v, std::vector<Real>& x, std::vector<Real>& y, std::vector<Real>& z) {
  for (KnotVector* const knots : {&u, &v}) knots->reserve(sculpted_control_point_count_range.high);
  for (std::vector<Real>* const axis : {&x, &y, &z}) {
    axis->reserve(static_cast<std::size_t>(refined_control_point_limit));
  }
}

void write_surface(const Surface& surface, SurfaceSnapshot& out) {
  const std::uint64_t structure = fingerprint_structure(surface);
  if (out.structure != structure) {
    out.u = surface.u;
    out.v = surface.v;
    out.structure = structure;
  }
  const auto copy = [](const std::vector<double>& from, std::vector<float>& to) {
    to.assign(from.begin(), from.end());
  };
  copy(surface.net.x, out.x);
  copy(surface.net.y, out.y);
  copy(surface.net.z, out.z);
}

void write_vertices(const std::vector<Vector3>& vertices, MeshSnapshot& out) {
  std::vector<float>* const axes[3] = {&out.x, &out.y, &out.z};
  for (int axis = 0; axis < 3; ++axis) {
    axes[axis]->resize(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      (*axes[axis])[v] = static_cast<float>(vertices[v][axis]);
    }
  }
}

void write_mesh(const MeshMapping& mesh, MeshSnapshot& out) {
  out.triangles = mesh.triangles();
  write_vertices(mesh.current().vertices_m(), out);
}

void write_lattice(const SpringLattice& lattice, const std::vector<std::uint8_t>& fixed,
                   const std::vector<std::uint8_t>& touched, LatticeSnapshot& out) {
  const LatticeMesh& mesh = lattice.mesh();
  const std::size_t count = static_cast<std::size_t>(mesh.node_count());
  for (std::vector<float>* values : {&out.x, &out.y, &out.z}) values->resize(count);
  for (std::vector<std::uint8_t>* marks : {&out.fixed, &out.touched, &out.on_shell, &out.in_body}) {
    marks->resize(count);
  }
  std::copy(mesh.count.begin(), mesh.count.end(), out.count);
  out.volume_change = lattice.rest_volume_change();
  std::size_t at = 0;
  for (int i = 0; i < mesh.count[0]; ++i) {
    for (int j = 0; j < mesh.count[1]; ++j) {
      for (int k = 0; k < mesh.count[2]; ++k, ++at) {
        const int node = mesh.index(i, j, k);
        const Vector3 position = lattice.position(node);
        out.x[at] = static_cast<float>(position.x());
        out.y[at] = static_cast<float>(position.y());
        out.z[at] = static_cast<float>(position.z());
        const NodeLocation place = mesh.node_location(i, j, k);
        out.in_body[at] = place != NodeLocation::outside_body;
        out.fixed[at] = out.in_body[at] & fixed[static_cast<std::size_t>(node)];
        out.touched[at] = out.in_body[at] & touched[static_cast<std::size_t>(node)];
        out.on_shell[at] = place == NodeLocation::on_shell;
      }
    }
  }
}

void write_material(const Material& material, const Sculpting& sculpting, const BodyState& body,
                    MaterialSnapshot& out) {
  out.name = material.name;
  out.youngs_modulus_pa = material.youngs_modulus_pa;
  out.inertia_scale = body.lattice.inertia_scale();
  out.implicit_nodes = body.solver() ? body.solver()->mesh().node_count() : 0;
  out.poissons_ratio = material.poissons_ratio;
  out.density_kg_per_m3 = material.density_kg_per_m3;
  out.drag_per_s = sculpting.drag_per_s;
  out.plastic = material.plastic;
  out.lattice_mass_kg = body.rigid ? 0.0 : body.lattice.mass_kg();
}

}  // namespace

void write_bodies(std::span<const BodyState> bodies, const Scene& scene, std::vector<BodySnapshot>& out) {
  if (out.size() > bodies.size()) out.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (b == out.size()) out.emplace_back();
    const MeshMapping* const mesh = bodies[b].mesh();
    if (out[b].is_mesh() != (mesh != nullptr)) out[b] = {};
    if (mesh) {
      write_mesh(*mesh, out[b].mesh);
    } else {
      const BodyMapping& mapping = bodies[b].mapping();
      SurfaceSnapshot& surface = out[b].surface;
      reserve(surface.u, surface.v, surface.x, surface.y, surface.z);
      write_surface(mapping.current(), surface);
      out[b].surface.trim = bodies[b].trim;
      out[b].residual = {mapping.residual().largest_m, mapping.residual().root_mean_square_m,
                         bodies[b].is_refined_enough};
    }
    out[b].shell_thickness_m = bodies[b].shell_thickness_m;
    out[b].is_rigid = bodies[b].rigid.has_value();
    write_lattice(bodies[b].lattice, bodies[b].fixed, bodies[b].touched, out[b].lattice);
    write_material(b < scene.bodies.size() ? scene.bodies[b].material : scene.tool.body->soft->material,
                   scene.sculpting, bodies[b], out[b].material);
  }
}

namespace {

ContactSnapshot make_contact_snapshot(std::size_t body, const BodyState& state,
                                      const SurfaceContact& contact) {
  ContactSnapshot snapshot;
  snapshot.body = static_cast<int>(body);
  snapshot.point_m = contact.point_m;
  snapshot.normal = contact.normal;
  snapshot.tangent_u = contact.tangent_u;
  snapshot.tangent_v = contact.tangent_v;
  snapshot.depth_m = contact.depth_m;
  snapshot.u = contact.u;
  snapshot.v = contact.v;
  snapshot.nodes = state.mapping().at(contact.u, contact.v);
  return snapshot;
}

// Adds the contact of the tool with each body that it is near.
void add_tool_contacts(const Simulation::State& s, std::vector<ContactSnapshot>& contacts) {
  if (!s.reaction.touching) return;
  for (std::size_t b = 0; b < s.scene.bodies.size(); ++b) {
    const CollisionResult& collision = s.tool.contact.collision(static_cast<int>(b));
    if (collision.found) contacts.push_back(make_contact_snapshot(b, s.bodies[b], collision.nearest));
  }
}

// Adds the contact of two bodies that push each other: one point on the surface of each.
void add_pair_contacts(const Simulation::State& s, const BodyPairContact& pair, std::size_t first,
                       std::size_t second, std::vector<ContactSnapshot>& contacts) {
  if (!s.between.acted(static_cast<int>(first), static_cast<int>(second))) return;
  const auto add = [&](std::size_t body, const std::optional<SurfaceSpot>& spot) {
    if (!spot) return;
    const BodyState& state = s.bodies[body];
    contacts.push_back(make_contact_snapshot(body, state, contact_at(state.mapping().current(), *spot)));
  };
  add(first, pair.deepest_on_first(s.bodies[first]));
  add(second, pair.deepest_on_second(s.bodies[second]));
}

}  // namespace

void write_contacts(const Simulation::State& s, std::vector<ContactSnapshot>& contacts) {
  contacts.reserve(s.scene.bodies.size() + 2 * s.pairs.size());
  contacts.clear();
  add_tool_contacts(s, contacts);
  auto pair = s.pairs.begin();
  for (std::size_t second = 1; second < s.stepped_count(); ++second) {
    for (std::size_t first = 0; first < second; ++first, ++pair) {
      add_pair_contacts(s, *pair, first, second, contacts);
    }
  }
}

MeshSnapshot make_mesh_snapshot(const TriangleMesh& mesh) {
  MeshSnapshot snapshot;
  snapshot.triangles = std::make_shared<const std::vector<TriangleCorners>>(mesh.triangles);
  write_vertices(mesh.vertices_m, snapshot);
  return snapshot;
}

void reserve_for_refinement(Snapshot& snapshot) {
  for (BodySnapshot& body : snapshot.bodies) {
    SurfaceSnapshot& surface = body.surface;
    if (!body.is_mesh()) reserve(surface.u, surface.v, surface.x, surface.y, surface.z);
  }
}

void reserve_for_refinement(Scene& scene) {
  for (Body& body : scene.bodies) {
    Surface& surface = body.surface;
    if (!body.mesh) reserve(surface.u, surface.v, surface.net.x, surface.net.y, surface.net.z);
  }
}

Result<Snapshot> make_scene_snapshot(const Scene& scene) {
  Snapshot snapshot;
  for (const Body& body : scene.bodies) {
    BodySnapshot& out = snapshot.bodies.emplace_back();
    if (body.mesh) {
      out.mesh = make_mesh_snapshot(find_placed_mesh(body));
    } else {
      write_surface(body.surface, out.surface);
      auto trim = make_trimmed_area(body);
      if (!trim) return trim.error().in("body \"" + body.name + "\"");
      out.surface.trim = std::move(trim).value();
    }
    out.shell_thickness_m = body.shell_thickness_m.value_or(0.0);
    out.is_rigid = body.kind != BodyKind::deformable;
    out.material.name = body.material.name;
  }
  for (const FixingPlane& plane : scene.planes) snapshot.planes.push_back({plane.point_m, plane.normal});
  const Tool& tool = scene.tool;
  snapshot.tool.kind = tool.kind;
  snapshot.tool.action = tool.action;
  snapshot.tool.radius_m = tool.radius_m;
  if (tool.body) snapshot.tool.body = std::make_shared<const ToolBody>(ToolBody{tool.body->solid, {}});
  return snapshot;
}

}  // namespace spoonbill
