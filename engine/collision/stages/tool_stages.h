// The stages of the contact of a surface with a tool that is a signed distance.
#pragma once

#include <memory>

#include "engine/base/result.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/collision/stages/contact_stages.h"

namespace spoonbill {

// What is shown is what a SurfaceCollider does that is asked for the first time: its cells, its spheres, its
// contacts. One owner, one thread. The knots are those of the surfaces given later.
class ToolStages {
 public:
  static Result<ToolStages> make(const KnotVector& u, const KnotVector& v);

  // Contacts are searched up to `margin_m` away; `closed` as in SurfaceCollider::collide(), `trim` as
  // when one is made.
  void add(const Surface& surface, const ToolShape& tool, double margin_m, bool closed, ContactStages& stages,
           std::shared_ptr<const TrimmedArea> trim = nullptr);

 private:
  explicit ToolStages(NestedGrid nested);
  void add_spheres(int surface, ContactStages& stages);
  void add_triangles(const ToolShape& tool, double margin_m, int surface, ContactStages& stages);
  void add_contacts(const Surface& surface, const ToolShape& tool, const CollisionResult& result,
                    ContactStages& stages);

  std::unique_ptr<NestedGrid> nested_;         // by pointer, which the collider keeps
  std::unique_ptr<SurfaceCollider> collider_;  // of the last add()
};

}  // namespace spoonbill
