// A snapshot: everything that drawing and the panel need of one tick, as plain data. Sized when the
// simulation is built; copying one snapshot onto another of the same sizes allocates nothing.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/material/lattice/embedded_point.h"
#include "engine/scene/tool.h"

namespace spoonbill {

struct SurfaceSnapshot {
  KnotVector u, v;
  std::uint64_t structure = 0;  // the knot vectors' fingerprint: while it stays, a Grid can be kept
  std::vector<float> x, y, z;   // control points in metres, as in ControlNet
  std::shared_ptr<const TrimmedArea> trim = {};  // what is there of it; none: all
};

// The triangles of a soft tool that is made of them, counter-clockwise seen from outside.
struct MeshSnapshot {
  std::shared_ptr<const std::vector<std::array<std::uint32_t, 3>>> triangles;  // the same while the tool is
  std::vector<float> x, y, z;                                                  // vertices in metres
};

// The nodes of a body's lattice, k fastest: node (i, j, k) at (i * count[1] + j) * count[2] + k, with k along
// the body. Edges join neighbours along each of the three directions.
struct LatticeSnapshot {
  int count[3] = {0, 0, 0};
  std::vector<float> x, y, z;          // metres
  std::vector<std::uint8_t> fixed;     // 1 where the node is held
  std::vector<std::uint8_t> touched;   // 1 where a contact acts on the node in this tick
  std::vector<std::uint8_t> on_shell;  // 1 where the node lies on the surface, or about it
  // 0 where a box about triangles has nodes far from them: those are neither fixed, touched nor drawn.
  std::vector<std::uint8_t> in_body;
};

struct ToolSnapshot {
  ToolKind kind = ToolKind::sphere;
  ToolAction action = ToolAction::push;
  int iterations = 0;
  double radius_m = 0.0;
  std::shared_ptr<const ToolBody> body;  // of a solid; a soft one is drawn as the last of the bodies
  Pose device;                           // where the hand holds it
  Pose proxy;                            // where the material stops it; this one is drawn
  bool button = false;
};

// A fixing plane: everything behind it (opposite to the normal) is held.
struct PlaneSnapshot {
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitX();
};

// Where a body is touched deepest: by the tool, or by another body.
struct ContactSnapshot {
  int body = 0;                       // of the snapshot's
  Vector3 point_m = Vector3::Zero();  // on its surface, where the tick found it
  Vector3 normal = Vector3::UnitY();  // unit, outward from the body
  Vector3 tangent_u = Vector3::UnitX(), tangent_v = Vector3::UnitZ();  // tangents_across() it
  double depth_m = 0.0;  // negative where what pushes it does not yet touch
  double u = 0.0, v = 0.0;
  EmbeddedPoint nodes;  // of its lattice, which a push there acts on, each by its weight
};

struct MaterialSnapshot {
  std::string name;
  double youngs_modulus_pa = 0.0;       // of the material
  double felt_youngs_modulus_pa = 0.0;  // what is stepped at 1 kHz
  int implicit_nodes = 0;               // of the block that steps it implicitly; 0: springs do, explicitly
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
  double damping_per_s = 0.0;  // mass-proportional
  bool plastic = false;
  double mass_kg = 0.0;  // of the body
};

// How far a body's surface stays behind its lattice, metres, since its knots or fixing planes last changed.
struct ResidualSnapshot {
  double largest_m = 0.0;
  double root_mean_square_m = 0.0;
};

struct BodySnapshot {
  SurfaceSnapshot surface;
  LatticeSnapshot lattice;
  MaterialSnapshot material;
  ResidualSnapshot residual = {};  // of a body with a surface
  MeshSnapshot mesh = {};          // of a soft mesh, which has no surface; no triangles otherwise
  double shell_thickness_m = 0.0;  // behind the surface; 0: it bounds a solid

  bool is_mesh() const { return mesh.triangles != nullptr; }
};

struct DeviceSnapshot {
  std::string name;
  double force_limit_n = 0.0;
  double force_scale = 0.0;
  double nominal_rate_hz = 1000.0;
};

// What a tick reports besides its result; each bit names its remedy.
enum TickFlag : std::uint32_t {
  tick_flag_none = 0,
  tick_flag_nodes_slowed = 1u << 0,      // the substep ceiling was met: strained nodes lag; move more slowly
  tick_flag_speed_capped = 1u << 1,      // a node met the speed cap: move the tool more slowly
  tick_flag_contact_overflow = 1u << 2,  // more contact points than the workspace holds: use a smaller tool
  tick_flag_force_limited = 1u << 3,     // the device's force limit was met: lower the force scale
  tick_flag_failed = 1u << 4,            // an internal fault broke the tick off: undo the stroke, or save
};

struct Snapshot {
  std::uint64_t tick = 0;
  std::vector<BodySnapshot> bodies;  // those of the scene, then a soft tool
  ToolSnapshot tool;
  std::vector<PlaneSnapshot> planes;
  bool symmetric = false;  // a second tool mirrors the first
  PlaneSnapshot symmetry;
  Pose mirrored_proxy;  // of the second tool, when symmetric
  std::vector<ContactSnapshot> contacts;
  Vector3 force_n = Vector3::Zero();  // on the hand, after scale and limit
  DeviceSnapshot device;
  int substeps = 0;  // of the last tick
  std::uint32_t flags = tick_flag_none;

  double time_s() const { return static_cast<double>(tick) * 1e-3; }
};

}  // namespace spoonbill
