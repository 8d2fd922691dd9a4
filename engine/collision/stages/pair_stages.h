// The stages of the contact of two surfaces.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/result.h"
#include "engine/collision/proximity/surface_proximity.h"
#include "engine/collision/stages/contact_stages.h"
#include "engine/collision/surfaces/surface_pair_collider.h"

namespace spoonbill {

// Of each cell that the descent of SurfacePairCollider visits, the sphere is shown; it drops a
// cell by slabs about the same patch, which are tighter, so that spheres of dropped cells may still meet.
// One owner, one thread. The knots are those of the surfaces given later.
class PairStages {
 public:
  static Result<PairStages> make(const Surface& first, const Surface& second);

  void add(const Surface& first, const Surface& second, double margin_m, bool first_closed,
           bool second_closed, ContactStages& stages);

 private:
  PairStages(NestedGrid first, NestedGrid second);
  // By SurfaceLevels::cell_index().
  using Marks = std::vector<std::uint8_t>;
  static std::vector<LevelCell> add_level(SurfaceLevels& levels, const std::vector<LevelCell>& visited,
                                          const Marks& kept, int surface, bool is_second,
                                          ContactStages& stages);
  void add_contacts(const Surface& first, const Surface& second, const PairQuery& query,
                    const PairResult& result, ContactStages& stages);
  int add_spheres(double margin_m, int first_surface, ContactStages& stages);
  void add_triangles(const std::vector<CellPair>& pairs, double margin_m, int first_surface,
                     ContactStages& stages);

  std::unique_ptr<NestedGrid> first_, second_;     // by pointer, which the collider keeps
  std::unique_ptr<SurfacePairCollider> collider_;  // of the last add()
  std::unique_ptr<SurfaceProximity> proximity_;
};

}  // namespace spoonbill
