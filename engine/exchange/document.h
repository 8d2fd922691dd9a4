// Reader and writer of documents, materials and commands. A document is a scene and its view, stored as
// human-readable JSON with lengths in mm. Fields marked "optional" may be missing; the text after the mark is
// the default value, or what a missing field means.
//
//   {"spoonbill_document": 3,
//    "name": "spoon handle",
//    "body": {
//      "name": "handle",
//      "surface": {
//        "u": {"degree": 3, "periodic": true, "knots": [...]},   one period, as for KnotVector::periodic
//        "v": {"degree": 3, "periodic": false, "knots": [...]},
//        "control_points_mm": [[[x, y, z], ...], ...],           a list along v for each point along u
//        "trims": [{"degree": 1, "periodic": false, "knots": [...],      optional, the whole surface;
//          "control_points_uv": [[u, v], ...]}, ...]},           closed curves in its domain (trim_loop.h)
//      "mesh": {"vertices_mm": [[x, y, z], ...], "triangles": [[0, 1, 2], ...]},   instead of "surface", for
//      a
//                                     fixed or rigid body (check_mesh())
//      "material": {"name": "clay", "source": "...", "youngs_modulus_pa": 2e5, "poissons_ratio": 0.45,
//        "density_kg_per_m3": 1700, "damping_time_s": 2e-5, "plastic": true, "yield_strain": 0.02,
//        "flow_rate_per_s": 240,
//        "hardening": 0.1, "stiffening": 2, "friction": 0.3,     each optional, 0
//        "relaxing_share": 0.5, "relaxation_time_s": 30,         optional, no creep
//        "yield_strength_pa": 4e7, "yield_source": "..."},       optional, not known
//      "kind": "fixed",               optional, "deformable"; a fixed or "rigid" body has no lattice,
//                                     regions, loads or supports
//      "hand": {"stiffness_n_per_m": 300, "turn_stiffness_nm_per_rad": 1},     optional, a rigid body is free
//      "motion": {"point_mm": [0, 0, 0], "waypoints": [                        optional, of a body that is
//        {"at_s": 1, "moved_mm": [0, 50, 0], "axis": [0, 0, 1], "angle_deg": 0}]}, fixed or held
//      "pose": {"position_mm": [0, 20, 0], "axis": [0, 0, 1], "angle_deg": 15},    optional, none; applied
//                                     when the body is read, and not written again (BodyPlacement)
//      "lattice": {"node_budget": 2000,                          or "nodes": [4, 8, 60]
//        "feature_map": {"draws_per_node": 500, "first_rate": 0.1, "last_rate": 0.01,
//          "first_neighbourhood": 2, "last_neighbourhood": 1, "seed": 1},      optional
//        "cells": "box"},                      optional, "bent"; not for shells or beside feature_map
//      "regions": [{"region": {...}, "material": {...}, "friction": 0.8}],     optional; material, friction
//                                                               or both
//      "loads": [{"kind": "pressure", "region": {...}, "pressure_pa": 500},    optional
//        {"kind": "force", "region": {...}, "force_n": [0, -2, 0], "shared_by": "surface"},  or "volume"
//        {"kind": "point", "u": 0.5, "v": 0.1, "force_n": [0, -2, 0]}],
//      "supports": [{"region": {...},                            optional
//        "motion": {"kind": "ramp", "way_mm": [0, 5, 0], "duration_s": 2}}],     optional, at rest
//      "shell_thickness_mm": 2,                                optional, a solid; see shell_lattice.h
//      "rim_uv": [[0, 0], [0, 1], ...],                        optional, no known rim; corners of a closed
//                                                              line on the surface (Body::rim)
//      "solid": "bracket"},                                    optional; bodies that share the name are faces
//                                                              of one solid of a CAD model
//    "other_bodies": [{"name": ...}, ...],                       optional; each as "body", at most 999; a
//                                                              simulation has at most 8 bodies
//    "fixing_planes": [{"point_mm": [20, 0, 0], "normal": [1, 0, 0]}],    optional
//    "tool": {"kind": "sphere", "action": "push", "radius_mm": 8, "substeps": 6,
//      "solid": {"shape": "box", "half_extents_mm": [4, 3, 10]},  for kind "solid"; see below
//      "soft": {"material": {...}, "lattice": {...},              optional, rigid
//        "grip": {"point_mm": [0, 1, 0], "normal": [0, -1, 0]}}},   in the tool's frame
//    "sculpting": {"drag_per_s": 24, "gravity_m_per_s2": [0, 0, 0], "force_scale": 1,
//      "settles": true,                                          optional, false: oscillates
//      "free": false,                      optional, false: a body that nothing fixes keeps its place
//      "real_time": false,                                       optional, false: bodies respond slower
//      "step_division": 1},                                      optional, 1; divides steps in real time
//    "ground": {"point_mm": [0, 0, 0], "normal": [0, 1, 0], "friction": 0.5},       optional
//    "symmetry": {"on": true, "point_mm": [0, 0, 0], "normal": [0, 0, 1]},          optional
//    "trial": {"lowered_body": "jelly", "lowering_speed_m_per_s": 0.01,             optional; TrialPlan in
//      "turned_body": "spoon", "point_mm": [0, 0, 0], "axis": [0, 0, 1],            scene.h gives the
//      "angle_deg": 10, "turn_speed_deg_per_s": 30},                                defaults of the fields
//    "view": {...}}                                              optional
//
// A region is a part of its body (BodyRegion in material.h): {"along": [0.9, 1], "around": [0.25, 0.75],
// "depth_mm": [0, 2]}. Each field is optional. If only one depth is given, it is the smallest, and the
// largest is unlimited. An oscillation has "frequency_hz" instead of "duration_s"; loads.h defines both
// motions. Where regions of material overlap, the later region applies.
//
// Shapes of a solid tool: sphere (radius_mm), ellipsoid (semi_axes_mm), cylinder and capsule (radius_mm,
// half_length_mm), box (half_extents_mm), cone (base_radius_mm, height_mm), torus (ring_radius_mm,
// tube_radius_mm), half_space, superquadric (semi_axes_mm, exponent_along, exponent_around), mesh
// (vertices_mm, triangles as three indices into the vertices each), and surface, with the fields of a body's
// surface except trims. A soft tool is a surface or a closed mesh; its "nodes" count along x, y and z, as in
// LatticeRequest (body.h). implicit_shapes.h and triangle_mesh.h define the shapes.
//
// Versions 1 and 2 are read too: old_documents.h converts their constants. In version 1, a body had neither
// "trims" nor "solid". assets/schemas/document.schema.json describes all three versions. Control points are
// in the world frame, the shape of a tool in the frame of the hand. The headers of engine/scene define the
// ranges. Knots are from -1e6 to 1e6, and unequal knots are at least 1e-9 of the domain apart. A length is a
// number of millimetres. If no double, divided by 1000, gives the exact length in metres, the length is a
// decimal in quotes (see length_to_json()). Normals are scaled to unit length.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/file.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/scene.h"

namespace spoonbill {

inline constexpr int document_version = 3;         // version that write_document() writes
inline constexpr int oldest_document_version = 1;  // oldest version that can be read

// Content of a document file. `view` belongs to the program that draws (camera, overlays) and is written as
// it was read.
struct Document {
  std::string name;
  Scene scene;
  Json view = Json::object();
};

// Converts JSON to a document. `source` names the file in messages. Unknown fields are refused, so that a
// misspelt field is not silently ignored. Numbers must be finite and within their ranges; the message gives
// the range.
Result<Document> document_from_json(const Json& json, const std::string& source);

// Converts a document to JSON. Every number reads back to the same bits, so that a document that is written,
// read and written again has the same bytes.
Json document_to_json(const Document& document);

// Reads a document of at most 128 MiB.
Result<Document> read_document(const std::filesystem::path& file);

// Writes a document to a temporary file beside `file`, flushes it and renames it, so that a crash leaves
// either the old or the new document complete. The old document is saved as FILE.bak. A document that could
// not be read back is refused before any file is touched. A pipe or a device that a person named is written
// to directly.
Status write_document(const Document& document, const std::filesystem::path& file,
                      const OutputOptions& options = {});

// material_from_json() and material_to_json() convert a single material, the content of a file in
// assets/materials.
Result<Material> material_from_json(const Json& json, const std::string& source);
Json material_to_json(const Material& material);
// Reads a material of at most 1 MiB. A material with the fields of former versions is converted
// (old_documents.h).
Result<Material> read_material(const std::filesystem::path& file);

// command_from_json() and command_to_json() convert a command of the simulation. Every field is required
// unless noted. The fields of tool, material and sculpting are the same as in documents:
//   {"command": "place_plane", "point_mm": [x, y, z], "normal": [x, y, z]}
//   {"command": "remove_planes"}
//   {"command": "set_tool", "kind", "action", "radius_mm", "substeps", and for a solid "solid", "soft"}
//   {"command": "keep_shape"}
//   {"command": "set_material", "name", "source", "youngs_modulus_pa", ..., and optionally "body": 1}
//   {"command": "set_sculpting", "drag_per_s", "gravity_m_per_s2", "force_scale", optionally "settles",
//   "free", "real_time", "step_division"}
//   {"command": "set_symmetry", "on", "point_mm", "normal"}
//   {"command": "reset_proxy"}
//   {"command": "lift_tool"}
//   {"command": "refine_knots", and optionally "body", "u": [low, high], "v": [low, high]}
//   {"command": "turn_body", "point_mm", "axis", "angle_deg", "speed_deg_per_s", and optionally "body"}
//   {"command": "lower_body", "speed_m_per_s", and optionally "body"}
//   {"command": "move_body", "point_mm", "waypoints": [{"at_s", "moved_mm", "axis", "angle_deg"}, ...], and
//   optionally "body"}
// "body" is the index in the list of all bodies, default: 0.
Result<Command> command_from_json(const Json& json, const std::string& source);
Json command_to_json(const Command& command);

// Returns true if the field "command" names a command of the simulation; recordings also contain commands of
// the view.
bool is_simulation_command(const Json& json);
// Returns the names of all commands of the simulation, separated by ", ", for messages.
std::string simulation_command_names();

}  // namespace spoonbill
