// Conversion between JSON and the parts of a scene that their table of fields (fields_of in field.h) does not
// describe completely, for documents and commands. All other parts use field_json.h. Each read_ function
// stores the first problem in its reader. Each add_ or _to_json function is the inverse of a read_ function.
#pragma once

#include <optional>
#include <vector>

#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"
#include "engine/scene/material.h"
#include "engine/scene/scene.h"

namespace spoonbill {

LatticeRequest read_lattice_request(FieldReader& reader);
void add_lattice_request(const LatticeRequest& lattice, Json& json);

// Reads and cleans the mesh that bounds a solid.
std::optional<CleanMesh> read_mesh(FieldReader& reader);
void add_mesh(const TriangleMesh& mesh, Json& json);

Tool read_tool(FieldReader& reader);
void add_tool(const Tool& tool, Json& json);

BodyRegion read_region(FieldReader reader);
Json region_to_json(const BodyRegion& region);

// Reads the optional list "regions" of a body, each with its own material, friction or both.
std::vector<MaterialRegion> read_material_regions(FieldReader& body);
void add_material_regions(const std::vector<MaterialRegion>& regions, Json& body);

// Reads a load of a body. The parameters of a point load must be within the domain of `surface`.
Load read_load(FieldReader& reader, const Surface& surface);
Json load_to_json(const Load& load);

Support read_support(FieldReader& reader);
Json support_to_json(const Support& support);

}  // namespace spoonbill
