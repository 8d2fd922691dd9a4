// What there is to say about the contact of two things, each a surface or a mesh.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/rigid/mesh_pair.h"
#include "engine/collision/surfaces/surface_pair_collider.h"
#include "engine/collision/surfaces/surface_self_collider.h"

namespace spoonbill {

struct SurfacePlace {
  double u, v;
  std::optional<ParameterRange> range;  // of the region of contact
};

// The nearest or deepest point of one of them.
struct ContactSide {
  Vector3 point_m = Vector3::Zero();
  std::optional<SurfacePlace> place;  // a mesh has none
  std::string body;                   // whose it is, where a document has several; else empty
};

struct ContactOfTwo {
  ContactSide a, b;
  Vector3 normal = Vector3::UnitY();  // unit, along which A leaves B
  double depth_m = 0.0;
  Vector3 tangent_u = Vector3::UnitX(), tangent_v = Vector3::UnitZ();  // unit, across the normal
};

struct CollisionAnswer {
  bool touching = false;
  bool contained = false;  // one is inside the other
  bool complete = true;    // nothing can be missing
  double distance_m =
      0.0;  // where they do not touch; infinite of one with itself, which has no nearest points
  ContactSide nearest_a, nearest_b;
  std::vector<ContactOfTwo> contacts;
};

CollisionAnswer answer_of(const PairResult& result, const std::vector<PairContact>& contacts);
CollisionAnswer answer_of(const MeshPairResult& result);
// Of one with itself, A and B its parts.
CollisionAnswer answer_of(const SelfResult& result, const std::vector<PairContact>& contacts);

// Those that touch have a depth, the deepest contact's, and contacts; others the distance between their
// nearest points.
void add_contact_facts(FactSheet& facts, const CollisionAnswer& answer);

}  // namespace spoonbill
