// The parts of a scene as JSON fields, shared by documents, material files and commands. Each read_ function
// takes the fields it names from the reader, which keeps the first problem; each add_ function is its
// inverse.
#pragma once

#include <optional>
#include <vector>

#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"
#include "engine/scene/scene.h"

namespace spoonbill {

FixingPlane read_fixing_plane(FieldReader& reader);
void add_fixing_plane(const FixingPlane& plane, Json& json);

LatticeRequest read_lattice_request(FieldReader& reader);
void add_lattice_request(const LatticeRequest& lattice, Json& json);

Material read_material_fields(FieldReader& reader);
void add_material_fields(const Material& material, Json& json);

Tool read_tool(FieldReader& reader);
void add_tool(const Tool& tool, Json& json);

Sculpting read_sculpting(FieldReader& reader);
void add_sculpting(const Sculpting& sculpting, Json& json);

BodyRegion read_region(FieldReader reader);
Json region_to_json(const BodyRegion& region);

// A point must be on the body's surface.
Load read_load(FieldReader& reader, const Surface& surface);
Json load_to_json(const Load& load);
Support read_support(FieldReader& reader);
Json support_to_json(const Support& support);

Ground read_ground(FieldReader& reader);
void add_ground(const Ground& ground, Json& json);

Symmetry read_symmetry(FieldReader& reader);
void add_symmetry(const Symmetry& symmetry, Json& json);

// Nothing after a problem: a surface has no harmless value.
std::optional<Surface> read_surface(FieldReader& reader);
Json surface_to_json(const Surface& surface);

// The trim loops of a surface, within its fields; none where there are none. What they bound is checked too.
std::vector<TrimLoop> read_trims(FieldReader& surface_reader, const Surface& surface);
void add_trims(const std::vector<TrimLoop>& trims, Json& surface_json);

// The knots of one direction of a surface, or of a loop. Nothing after a problem.
std::optional<KnotVector> read_knot_vector(FieldReader& reader, Range<int> control_point_counts);
void add_knot_vector(const KnotVector& knots, Json& json);

// False where it is not three lengths within position_range_m.
bool read_point(const Json& json, Vector3& point_m);

Json position_to_json(const Vector3& position_m);
Json vector_to_json(const Vector3& vector);

}  // namespace spoonbill
