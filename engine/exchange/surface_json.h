// Conversion between JSON and surfaces, knot vectors, trim loops and points. Each read_ function stores the
// first problem in its reader; each add_ or _to_json function is the inverse of a read_ function.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Reads the fields "u", "v" and "control_points_mm". Returns nullopt after a problem, because there is no
// harmless surface to return instead.
std::optional<Surface> read_surface(FieldReader& reader);
Json surface_to_json(const Surface& surface);

// Reads the optional field "trims" of a surface and checks that the loops bound an area of the surface.
// Returns an empty list if the field is missing.
std::vector<TrimLoop> read_trims(FieldReader& surface_reader, const Surface& surface);
void add_trims(const std::vector<TrimLoop>& trims, Json& surface_json);

// Reads the fields "degree", "periodic" and "knots" of a trim loop or of one direction of a surface. Returns
// nullopt after a problem.
std::optional<KnotVector> read_knot_vector(FieldReader& reader, Range<int> control_point_counts);
void add_knot_vector(const KnotVector& knots, Json& json);

// Converts a list of three lengths. Returns false if the value is not a list of three lengths, or if a length
// is outside position_range_m.
bool read_point(const Json& json, Vector3& point_m);
// Reads a list of two numbers. Returns false if the value is not such a list, or if a number is out of range.
bool read_parameters(const Json& json, double& u, double& v);
Json position_to_json(const Vector3& position_m);

}  // namespace spoonbill
