// The contact of a mesh with a body's surface.
#pragma once

#include "app/report/contact_facts.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// The surface bounds a body and stands where it is; the mesh stands in the pose. `mesh_is_a` says which of
// them is A in the answer. Depths are those of the surface in the mesh, or of a mesh that lies in the body.
Result<CollisionAnswer> collide_mesh(const SignedDistance& mesh, const Pose& mesh_pose,
                                     const Surface& surface, bool mesh_is_a);

}  // namespace spoonbill
