// The parts of a scene that a table of fields does not describe whole, as JSON, shared by documents and
// commands; field_json.h has the rest. Each read_ function takes the fields it names from the reader, which
// keeps the first problem; each add_ function is its inverse.
#pragma once

#include <optional>
#include <vector>

#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"
#include "engine/scene/scene.h"

namespace spoonbill {

LatticeRequest read_lattice_request(FieldReader& reader);
void add_lattice_request(const LatticeRequest& lattice, Json& json);

Tool read_tool(FieldReader& reader);
void add_tool(const Tool& tool, Json& json);

BodyRegion read_region(FieldReader reader);
Json region_to_json(const BodyRegion& region);

// A point must be on the body's surface.
Load read_load(FieldReader& reader, const Surface& surface);
Json load_to_json(const Load& load);
Support read_support(FieldReader& reader);
Json support_to_json(const Support& support);

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

}  // namespace spoonbill
