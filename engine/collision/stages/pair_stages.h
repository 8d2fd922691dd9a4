// Stages of the contact of two surfaces.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/result.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/stages/contact_stages.h"
#include "engine/collision/surfaces/surface_pair_collider.h"

namespace spoonbill {

// Records the stages of a SurfacePairCollider. The sphere of each visited cell is recorded, but the collider
// drops cells by thin slabs (SlabGroup), which bound the surface more tightly than spheres. The spheres of
// dropped cells may therefore still meet. Not thread-safe. Surfaces given to add() must have the same knots
// as the surfaces given to make().
class PairStages {
 public:
  static Result<PairStages> make(const Surface& first, const Surface& second);

  // Adds the stages of a contact search up to `margin_m`. `first_closed` and `second_closed` are true if that
  // surface bounds a body, with du x dv pointing outward.
  void add(const Surface& first, const Surface& second, double margin_m, bool first_closed,
           bool second_closed, ContactStages& stages);

 private:
  PairStages(NestedGrid first, NestedGrid second);
  // Flags of cells, indexed by SurfaceLevels::cell_index().
  using Marks = std::vector<std::uint8_t>;
  static std::vector<LevelCell> add_level(SurfaceLevels& levels, const std::vector<LevelCell>& visited,
                                          const Marks& kept, int surface, bool is_second,
                                          ContactStages& stages);
  void add_contacts(const Surface& first, const Surface& second, const PairQuery& query,
                    const PairResult& result, ContactStages& stages);
  int add_spheres(double margin_m, int first_surface, ContactStages& stages);
  void add_triangles(const std::vector<CellPair>& pairs, double margin_m, int first_surface,
                     ContactStages& stages);

  std::unique_ptr<NestedGrid> first_, second_;     // on the heap, because the collider stores their addresses
  std::unique_ptr<SurfacePairCollider> collider_;  // collider of the last add()
  std::unique_ptr<SurfaceProximity> proximity_;
};

}  // namespace spoonbill
