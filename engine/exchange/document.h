// Documents: a scene and how it is looked at, as JSON that a person can read, lengths in mm.
//
//   {"spoonbill_document": 2,
//    "name": "spoon handle",
//    "body": {
//      "name": "handle",
//      "surface": {
//        "u": {"degree": 3, "periodic": true, "knots": [...]},   one period, as KnotVector::periodic takes it
//        "v": {"degree": 3, "periodic": false, "knots": [...]},
//        "control_points_mm": [[[x, y, z], ...], ...],           a list along v for each point along u
//        "trims": [{"degree": 1, "periodic": false, "knots": [...],      may be left out: all of the surface
//          "control_points_uv": [[u, v], ...]}, ...]},           closed curves in its domain (trim_loop.h)
//      "material": {"name": "clay", "source": "...", "youngs_modulus_pa": 2e5, "poissons_ratio": 0.45,
//        "density_kg_per_m3": 1700, "damping_ratio": 0.1, "plastic": true, "yield_strain": 0.02,
//        "flow_rate_per_s": 40,                                  "loss_factor": 0.2 may stand for a
//                                                                damping ratio of half of it
//        "hardening": 0.1, "stiffening": 2, "friction": 0.3,         may be left out: 0
//        "relaxing_share": 0.5, "relaxation_time_s": 30},            may be left out: does not creep
//      "lattice": {"node_budget": 2000,                          or "nodes": [4, 8, 60]
//        "feature_map": {"draws_per_node": 500, "first_rate": 0.1, "last_rate": 0.01,
//          "first_neighbourhood": 2, "last_neighbourhood": 1, "seed": 1}},     may be left out
//      "regions": [{"region": {...}, "material": {...}, "friction": 0.8}],     may be left out; of material
//                                                               and friction one at least
//      "loads": [{"kind": "pressure", "region": {...}, "pressure_pa": 500},    may be left out
//        {"kind": "force", "region": {...}, "force_n": [0, -2, 0], "shared_by": "surface"},  or "volume"
//        {"kind": "point", "u": 0.5, "v": 0.1, "force_n": [0, -2, 0]}],
//      "supports": [{"region": {...},                            may be left out
//        "motion": {"kind": "ramp", "way_mm": [0, 5, 0], "duration_s": 2}}],     may be left out: is still
//      "shell_thickness_mm": 2,                                may be left out: solid; see shell_lattice.h
//      "solid": "bracket"},                                    may be left out; of those of one name, each is
//                                                              a face of one solid that came from CAD
//    "other_bodies": [{"name": ...}, ...],                       each as "body", at most 999, of which few
//                                                              are sculpted together; may be left out
//    "fixing_planes": [{"point_mm": [20, 0, 0], "normal": [1, 0, 0]}],    may be left out
//    "tool": {"kind": "sphere", "action": "push", "radius_mm": 8, "iterations": 6,
//      "solid": {"shape": "box", "half_extents_mm": [4, 3, 10]},  of kind solid; see below
//      "soft": {"material": {...}, "lattice": {...},              may be left out: rigid
//        "grip": {"point_mm": [0, 1, 0], "normal": [0, -1, 0]}}},   in the tool's frame
//    "sculpting": {"damping_per_s": 4, "gravity_m_per_s2": [0, 0, 0], "force_scale": 1,
//      "settles": true},                                         may be left out: swings
//    "ground": {"point_mm": [0, 0, 0], "normal": [0, 1, 0], "friction": 0.5},       may be left out
//    "symmetry": {"on": true, "point_mm": [0, 0, 0], "normal": [0, 0, 1]},          may be left out
//    "view": {...}}                                              may be left out
//
// A region is a part of its body (body_region.h): {"along": [0.9, 1], "around": [0.25, 0.75], "depth_mm": [0,
// 2]}, of which each may be left out; one depth alone is from there inwards. An oscillation has
// "frequency_hz" instead of "duration_s"; loads.h says how both move. Of regions of material, later ones win.
//
// Shapes of a solid: sphere (radius_mm), ellipsoid (semi_axes_mm), cylinder and capsule (radius_mm,
// half_length_mm), box (half_extents_mm), cone (base_radius_mm, height_mm), torus (ring_radius_mm,
// tube_radius_mm), half_space, superquadric (semi_axes_mm, exponent_along, exponent_around), mesh
// (vertices_mm, triangles as three places of vertices each), and surface, with the fields of a body's
// surface but trims. Soft may be a surface, or a mesh that is closed; its "nodes" count along x, y and z,
// as those of a body that lies in a box of cells (solid_lattice.h).
// implicit_shapes.h and triangle_mesh.h say what is meant.
//
// Version 2; version 1, which had neither trims nor solids, is read too, and
// assets/schemas/document.schema.json holds for both. A body's pose is where its control points stand, a
// tool's that of the hand. The ranges stand in scene.h and material.h; knots lie within a million of zero and
// are equal or at least a billionth of the domain apart. A length is a number, or a decimal in quotes where
// no double of millimetres reads back to the same bits of metres (length.h). Normals of another length than 1
// are scaled.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/scene.h"

namespace spoonbill {

inline constexpr int document_version = 2;         // that is written
inline constexpr int oldest_document_version = 1;  // that is read

// What is saved. `view` belongs to the program that draws (camera, overlays) and is kept as it was read.
struct Document {
  std::string name;
  Scene scene;
  Json view = Json::object();
};

// `source` names the file in messages. Unknown fields are refused by name, so that a misspelt one is not
// silently ignored; numbers must be finite and within the ranges that the message states.
Result<Document> document_from_json(const Json& json, const std::string& source);

// Every number reads back to the same bits, so that writing what was read gives the same bytes again.
Json document_to_json(const Document& document);

// At most 64 MiB is read.
Result<Document> read_document(const std::filesystem::path& file);

// Written beside the file, flushed and renamed, so that a crash leaves the old or the new document whole; the
// old one stays as FILE.bak. Refused before anything is touched: a document that could not be read back.
Status write_document(const Document& document, const std::filesystem::path& file);

// A material by itself, as assets/materials holds them.
Result<Material> material_from_json(const Json& json, const std::string& source);
Json material_to_json(const Material& material);
Result<Material> read_material(const std::filesystem::path& file);

// One form a command, every field required unless said (those of tool, material and sculpting are the
// document's):
//   {"command": "place_plane", "point_mm": [x, y, z], "normal": [x, y, z]}      {"command": "remove_planes"}
//   {"command": "set_tool", "kind", "action", "radius_mm", "iterations" and, of a solid, "solid", "soft"}
//          {"command": "keep_shape"}
//   {"command": "set_material", "name", "source", "youngs_modulus_pa", ...}
//     and, but for the first, "body": 1, its place in the list of all bodies
//   {"command": "set_sculpting", "damping_per_s", "gravity_m_per_s2", "force_scale",
//     "settles" may be left out}
//   {"command": "set_symmetry", "on", "point_mm", "normal"}     {"command": "reset_proxy"}
//   {"command": "lift_tool"}
//   {"command": "refine_knots"} and, but for the first body, "body"
Result<Command> command_from_json(const Json& json, const std::string& source);
Json command_to_json(const Command& command);

// Whether "command" names one of the above; recordings also hold commands that belong to the view.
bool is_simulation_command(const Json& json);
// All their names, for messages.
std::string simulation_command_names();

}  // namespace spoonbill
