// Stages of the contact of a surface with a tool.
#pragma once

#include <memory>

#include "engine/base/result.h"
#include "engine/collision/solids/surface_collider.h"
#include "engine/collision/stages/contact_stages.h"

namespace spoonbill {

// Records the stages of a SurfaceCollider: its cells, spheres, triangles and contacts. Not thread-safe.
// Surfaces given to add() must have the knots that were given to make().
class ToolStages {
 public:
  static Result<ToolStages> make(const KnotVector& u, const KnotVector& v);

  // Adds the stages of a contact search up to `margin_m`. `closed` is true if the surface bounds a body,
  // which may contain the tool. `trim` restricts the surface to a trimmed area.
  void add(const Surface& surface, const ToolShape& tool, double margin_m, bool closed, ContactStages& stages,
           std::shared_ptr<const TrimmedArea> trim = nullptr);

 private:
  explicit ToolStages(NestedGrid nested);
  void add_spheres(int surface, ContactStages& stages);
  void add_triangles(const ToolShape& tool, double margin_m, int surface, ContactStages& stages);
  void add_contacts(const Surface& surface, const ToolShape& tool, const CollisionResult& result,
                    ContactStages& stages);

  std::unique_ptr<NestedGrid> nested_;         // on the heap, because the collider stores its address
  std::unique_ptr<SurfaceCollider> collider_;  // collider of the last add()
};

}  // namespace spoonbill
