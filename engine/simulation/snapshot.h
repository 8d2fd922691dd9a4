// Snapshot of one tick for drawing and the panel. Plain data; copying onto a snapshot of the same sizes
// allocates nothing.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/scene/tool.h"

namespace spoonbill {

struct Scene;
struct TriangleMesh;

struct SurfaceSnapshot {
  KnotVector u, v;
  std::uint64_t structure = 0;  // fingerprint of the knots; equal fingerprints mean equal Grids
  std::vector<float> x, y, z;   // control points in metres, as in ControlNet
  std::shared_ptr<const TrimmedArea> trim = {};  // area within the trims; null without trims
};

// Triangles of a body with a mesh or of a soft mesh tool, counter-clockwise seen from outside.
struct MeshSnapshot {
  // Shared by all snapshots while the tool stays the same.
  std::shared_ptr<const std::vector<std::array<std::uint32_t, 3>>> triangles;
  std::vector<float> x, y, z;  // vertices in metres
  bool is_closed = true;       // false if both sides of the triangles may be seen, as of a scan
};

// Nodes of a body's lattice. Node (i, j, k) has the index (i * count[1] + j) * count[2] + k, with k along the
// body. Edges join neighbours in each of the three directions.
struct LatticeSnapshot {
  int count[3] = {0, 0, 0};
  std::vector<float> x, y, z;          // positions in metres
  std::vector<std::uint8_t> fixed;     // 1 where the node is fixed
  std::vector<std::uint8_t> touched;   // 1 where a contact acted on the node in this tick
  std::vector<std::uint8_t> on_shell;  // 1 where the node is on the surface or next to it
  // 1 for nodes in or on the body, 0 for other nodes of a box lattice, which are not fixed, touched or drawn.
  std::vector<std::uint8_t> in_body;
  double volume_change = 0.0;  // by which strokes have changed the rest volume, as a fraction of it
};

struct ToolSnapshot {
  ToolKind kind = ToolKind::sphere;
  ToolAction action = ToolAction::push;
  int substeps = 0;  // number of substeps at rest that the tool requests
  double radius_m = 0.0;
  // Body of a solid tool. A soft tool is drawn as the last of the bodies instead.
  std::shared_ptr<const ToolBody> body;
  Pose device;  // pose of the hand
  Pose proxy;   // pose at which the material stops the tool; the tool is drawn there
  bool button = false;
  bool is_local = false;  // whether strokes have local reach
  // Body, centre and radius of a stroke of local reach: the touched point, or the nearest point of a tool
  // that is close, and the radius along the surface; 0 for none.
  int local_body = 0;
  Vector3 local_point_m = Vector3::Zero();
  double local_radius_m = 0.0;
};

// Plane of symmetry, or fixing plane, which fixes everything on the side opposite to its normal.
struct PlaneSnapshot {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitX();
};

// Deepest contact of a body with the tool or with another body.
struct ContactSnapshot {
  int body = 0;                       // index of the body in Snapshot::bodies
  Vector3 point_m = Vector3::Zero();  // point of the body's surface, as the tick found it
  Vector3 normal = Vector3::UnitY();  // unit normal, outward from the body
  Vector3 tangent_u = Vector3::UnitX(), tangent_v = Vector3::UnitZ();  // unit tangents, see tangents_across()
  double depth_m = 0.0;  // depth of the penetration; negative for a gap
  double u = 0.0, v = 0.0;
  EmbeddedPoint nodes;  // nodes of the body's lattice that a push at the point moves
};

struct MaterialSnapshot {
  std::string name;
  double youngs_modulus_pa = 0.0;
  double inertia_scale = 1.0;  // r: the body responds sqrt(r) times slower than the real one
  int implicit_nodes = 0;      // number of nodes of the implicit solver; 0 for the spring solver
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
  double drag_per_s = 0.0;  // mass-proportional drag
  bool plastic = false;
  double lattice_mass_kg = 0.0;  // mass of the lattice, which ignores the trims of the body
};

// Part of the lattice's displacement that a body's surface does not follow, where the surface is free to
// move.
struct ResidualSnapshot {
  double largest_m = 0.0;
  double root_mean_square_m = 0.0;
  bool is_at_limit =
      false;  // true if it is beyond the tolerance and more knots would not help or be too many
};

struct BodySnapshot {
  SurfaceSnapshot surface;
  LatticeSnapshot lattice;
  MaterialSnapshot material;
  ResidualSnapshot residual = {};  // only for bodies with a surface
  MeshSnapshot mesh = {};          // only for bodies with a mesh and soft mesh tools, which have no surface
  double shell_thickness_m = 0.0;  // thickness behind the surface; 0 for a solid
  bool is_rigid = false;           // true for a fixed or rigid body, whose lattice is only a frame

  bool is_mesh() const { return mesh.triangles != nullptr; }
};

struct DeviceSnapshot {
  std::string name;
  double force_limit_n = 0.0;
  double force_scale = 0.0;
  double nominal_rate_hz = 1000.0;
};

// Events in a tick. The comment of each bit states the cause and a remedy.
enum TickFlag : std::uint32_t {
  tick_flag_none = 0,
  tick_flag_nodes_slowed = 1u << 0,      // substep limit reached, strained nodes lag: move more slowly
  tick_flag_speed_capped = 1u << 1,      // a node reached the speed limit: move the tool more slowly
  tick_flag_contact_overflow = 1u << 2,  // too many contact points for the workspace: use a smaller tool
  tick_flag_force_limited = 1u << 3,     // the device's force limit was reached: lower the force scale
  tick_flag_failed = 1u << 4,            // an internal fault aborted the tick: undo the stroke, or save
  tick_flag_body_limited = 1u << 5,  // a body could not follow and kept its last shape: move the tool away
};

struct Snapshot {
  std::uint64_t tick = 0;
  std::vector<BodySnapshot> bodies;  // bodies of the scene, then the tool if it is soft
  ToolSnapshot tool;
  std::vector<PlaneSnapshot> planes;
  bool symmetric = false;  // true if a second tool mirrors the first
  PlaneSnapshot symmetry;
  Pose mirrored_proxy;  // proxy of the second tool, if symmetric
  std::vector<ContactSnapshot> contacts;
  Vector3 force_n = Vector3::Zero();  // force on the hand, after force scale and limit
  DeviceSnapshot device;
  int substeps = 0;  // number of substeps of the last tick
  // Number of substeps that a tick would take in real time, that is with an inertia scale of 1.
  int real_time_substeps = 0;
  std::uint32_t flags = tick_flag_none;

  double time_s() const { return static_cast<double>(tick) * 1e-3; }
};

MeshSnapshot make_mesh_snapshot(const TriangleMesh& mesh);

// Returns the bodies, fixing planes and tool of a scene as they are, without a simulation and so without
// lattices. The tool is rigid and at the origin. Errors: those of make_trimmed_area(), with the name of the
// body.
Result<Snapshot> make_scene_snapshot(const Scene& scene);

}  // namespace spoonbill
