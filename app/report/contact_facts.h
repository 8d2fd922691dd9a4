// The report of the collide command: contacts between two models or within one, and the meshes that were read
// and cleaned for it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/files/length_unit.h"
#include "app/report/fact_sheet.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/rigid/mesh_pair.h"
#include "engine/collision/surfaces/surface_pair_collider.h"
#include "engine/collision/surfaces/surface_self_collider.h"

namespace spoonbill {

struct SurfaceParameters {
  double u, v;
  std::optional<ParameterRange> range;  // extent of the contact region around the point
};

// The point of one model in a contact, or in the nearest pair of points.
struct ContactSide {
  Vector3 point_m = Vector3::Zero();
  std::optional<SurfaceParameters> parameters;  // parameters on the surface; empty on a mesh
  std::string body;                             // name of the body; empty if the model has one body
};

struct ModelContact {
  ContactSide a, b;                   // deepest point on each side
  Vector3 normal = Vector3::UnitY();  // unit direction in which A moves away from B
  double depth_m = 0.0;
  // Unit vectors, perpendicular to the normal.
  Vector3 tangent_u = Vector3::UnitX(), tangent_v = Vector3::UnitZ();
};

struct CollisionAnswer {
  bool touching = false;
  bool contained = false;  // true if one model is inside the other
  bool complete = true;    // false if contacts may be missing
  // Distance between models that do not touch; infinite if a model is collided with itself.
  double distance_m = 0.0;
  ContactSide nearest_a, nearest_b;
  std::vector<ModelContact> contacts;
};

CollisionAnswer make_answer(const PairResult& result, const std::vector<PairContact>& contacts);
CollisionAnswer make_answer(const MeshPairResult& result);
// Makes the answer for a surface that is collided with itself: A and B are two parts of that surface.
CollisionAnswer make_answer(const SelfResult& result, const std::vector<PairContact>& contacts);

// Adds the depth and the contacts if the models touch; otherwise their distance and nearest points.
void add_contact_facts(FactSheet& facts, const CollisionAnswer& answer);

// Adds the unit, size, cleaning and parts of a mesh, in the JSON under `field`. `suffix` follows each label,
// such as " of A" when both models are meshes. Open parts count as plates of thickness `sheet_thickness_m`.
void add_mesh_facts(FactSheet& facts, const LengthUnit& unit, const CleanMesh& mesh, double sheet_thickness_m,
                    const std::string& field = "mesh", const std::string& suffix = "");

}  // namespace spoonbill
