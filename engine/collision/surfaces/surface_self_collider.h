// Contact of a B-spline surface with itself, open, periodic or closed: the descent of surface_pair_collider.h
// with both sides the same surface. Cells that are joined, having a corner in common, across a seam or in a
// pole too, always meet there: they are left out as soon as they provably meet nowhere else (patch_folds.h),
// and split until then.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/collision/levels/element_tree.h"
#include "engine/collision/surfaces/contact_regions.h"
#include "engine/collision/surfaces/pair_contact.h"
#include "engine/collision/surfaces/pair_search.h"
#include "engine/collision/surfaces/patch_folds.h"
#include "engine/collision/surfaces/region_places.h"

namespace spoonbill {

struct SelfQuery {
  // Whether it bounds a body: du x dv then points outwards. An open surface has two sides, and the shorter
  // way out counts.
  bool closed = false;
  Progress progress = {};  // of what is searched; may stop the search
};

struct SelfResult {
  bool touching = false;  // decided to touch_tolerance_m
  // A capacity was met, and a contact may be missing. Remedy: a surface of fewer elements or fewer levels.
  bool overflow = false;
  bool stopped = false;  // on request: what was found until then
};

// One owner, one thread; allocates only when made. The grid must outlive it.
//
// Joined cells of the finest level are not told apart: a loop that the surface makes within two of them, and
// the sharp edge along which it folds back, are no contact. More levels find smaller loops.
class SurfaceSelfCollider {
 public:
  explicit SurfaceSelfCollider(const NestedGrid& nested);
  SurfaceSelfCollider(const SurfaceSelfCollider&) = delete;
  SurfaceSelfCollider& operator=(const SurfaceSelfCollider&) = delete;

  SelfResult collide(const Surface& surface, const SelfQuery& query);

  // Of the last collide(): each region once, by the places on both parts of the surface, in any order.
  const std::vector<PairContact>& contacts() const { return contacts_; }

 private:
  // What joins cells beyond having a corner in common in the grid.
  struct Joints {
    bool seam = false;                         // both ends of the direction are one edge
    bool low_pole = false, high_pole = false;  // an end is a single point
  };
  class NotJoined final : public PairJudge {
   public:
    explicit NotJoined(const SurfaceSelfCollider& of) : of_(&of) {}
    bool counts(const PairParameters& at) const override;

   private:
    const SurfaceSelfCollider* of_;
  };
  using Pairs = std::vector<CellPair>;
  using Region = ContactRegions::Region;

  Joints joints_of(bool in_u);
  bool are_joined(const LevelCell& a, const LevelCell& b) const;
  LevelCell cell_at(double u, double v) const;
  void take_pairs(int level);
  void descend(const CellPair& elements, int level);
  bool can_meet(const CellPair& pair, int level);
  bool joined_can_meet(const CellPair& pair);
  void emit(const CellPair& pair, int level);
  void split(const CellPair& pair);
  bool is_mirror_of_earlier(const Region& region) const;
  bool touches(const RegionCells& cells);
  bool goes_on(double fraction);
  PairContact contact_of(const RegionCells& cells, const SelfQuery& query) const;
  void settle(PairContact& contact, const PairParameters& from, double outside, const SelfQuery& query,
              double& shortest) const;

  SurfaceLevels levels_;
  ElementTree tree_;
  PatchFolds folds_;
  NotJoined not_joined_;
  PairSearch search_;
  ContactRegions regions_;
  Joints u_, v_;
  Pairs pairs_;                            // both ways round
  std::vector<CellPair> path_;             // working memory: what is left to split of two elements
  std::vector<std::array<int, 2>> nodes_;  // working memory: a path down the tree, twice
  std::vector<PairContact> contacts_;
  bool overflow_ = false, stopped_ = false;
  const SelfQuery* query_ = nullptr;  // while it is answered
  std::uint64_t asked_ = 0;
};

}  // namespace spoonbill
