// Contact of two B-spline surfaces through levels of detail of their blending matrices (section 4.1 of
// Pungotra et al. 2013): the cells that could meet are found from coarse to fine, grouped to regions, and
// what they do is settled on the true surfaces.
#pragma once

#include <limits>
#include <vector>

#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/surfaces/contact_regions.h"
#include "engine/collision/surfaces/pair_contact.h"
#include "engine/collision/surfaces/pair_search.h"
#include "engine/collision/surfaces/region_middle.h"
#include "engine/collision/surfaces/region_places.h"

namespace spoonbill {

struct PairQuery {
  // Whether they bound bodies: du x dv then points outwards, and one body may be inside the other. An open
  // surface has two sides, and the shorter way out counts.
  bool first_closed = false, second_closed = false;
  // Up to which distance the nearest points of surfaces that do not touch are searched for.
  double reach_m = 0.0;
  // All samples of a grid, where they are known already (see SurfaceLevels::begin()): none is then evaluated.
  PlanarPoints first_samples, second_samples;
};

struct PairResult {
  bool touching = false;   // decided to touch_tolerance_m
  bool contained = false;  // touching, with one inside the other: the one contact says how it gets out
  // Of surfaces that do not touch, infinite beyond the reach. No points are nearer by more than a
  // ten-thousandth of it or of the smaller surface's size.
  double distance_m = std::numeric_limits<double>::infinity();
  SurfacePair nearest;
  // A capacity was met, and a contact may be missing. Remedy: surfaces of fewer elements or a smaller reach.
  bool overflow = false;
  int samples_evaluated = 0;
};

// Keeps what it evaluated of a surface until its control points move, and looks first where it found the last
// contacts. One owner, one thread; allocates only when made. The grids must outlive it.
class SurfacePairCollider {
 public:
  SurfacePairCollider(const NestedGrid& first, const NestedGrid& second);
  SurfacePairCollider(const SurfacePairCollider&) = delete;
  SurfacePairCollider& operator=(const SurfacePairCollider&) = delete;

  PairResult collide(const Surface& first, const Surface& second, const PairQuery& query);

  // Of the last collide().
  const std::vector<PairContact>& contacts() const { return contacts_; }
  // The pairs of cells in which the surfaces could cross or touch, of regions that do and of others.
  const std::vector<CellPair>& cells() const { return cells_.pairs(); }

  // For overlays, after collide(), of the same surfaces. Asked for pairs, they leave others in cells().
  CellPairs& cell_pairs() { return cells_; }
  SurfaceLevels& first_levels() { return first_; }
  SurfaceLevels& second_levels() { return second_; }

 private:
  // By side of the second surface: behind it, before it.
  struct Seeds {
    double middle_depth = 0.0;
    double depth[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    PairParameters at[2];
  };
  using Pairs = std::vector<CellPair>;
  using Region = ContactRegions::Region;

  // Where the surfaces touched or crossed, and where the first was deepest, by side of the second as in
  // Seeds.
  struct Seed {
    PairParameters touch, deepest[2];
    bool deep[2] = {false, false};
  };

  void take_contacts(const PairQuery& query);
  const Seed* last_seed(const PairContact& contact) const;
  bool touches(const RegionCells& cells, const Seed* last);
  Seed settle(const RegionCells& cells, const PairQuery& query, const Seed* last, PairContact& contact) const;
  RegionMiddle middle_of(const RegionCells& cells) const;
  Seeds seeds_of(const RegionCells& cells, const Seed* last) const;
  void take_inner_touch(const RegionCells& cells, PairContact& contact) const;
  void settle_from(PairContact& contact, PairParameters& from, double outside, bool first_closed,
                   double shortest) const;
  void find_nearest(const PairQuery& query, PairResult& result);
  bool may_contain(const PairQuery& query) const;
  double tolerance() const;
  double search_all(double reach);
  bool is_contained(const PairQuery& query) const;
  PairContact containment() const;

  SurfaceLevels first_, second_;
  CellPairs cells_;
  ContactRegions regions_;
  PairSearch search_;
  std::vector<PairContact> contacts_;
  std::vector<Seed> seeds_, last_seeds_;  // of the contacts, and of those of the last collide()
  std::size_t query_ = 0;
  PairParameters nearest_;  // of the last surfaces that did not touch
  bool nearest_known_ = false;
  bool touched_ = false;  // in the last collide(): tells what to try first, never what comes of it
};

}  // namespace spoonbill
