// Contact of two B-spline surfaces through levels of detail (section 4.1 of Pungotra et al. 2013). Cells that
// may meet are found from coarse to fine and grouped into regions, whose contacts are computed on the exact
// surfaces.
#pragma once

#include <limits>
#include <vector>

#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/surfaces/contact_regions.h"
#include "engine/collision/surfaces/pair_polish.h"
#include "engine/collision/surfaces/pair_search.h"

namespace spoonbill {

// Options of SurfacePairCollider::collide().
struct PairQuery {
  // True if the surface bounds a body: du x dv then points outward, and one body may be inside the other. For
  // an open surface, the depth is measured on both sides, and the smaller value counts.
  bool first_closed = false, second_closed = false;
  // Largest distance, in metres, at which the nearest points of surfaces that do not touch are searched.
  double reach_m = 0.0;
  // Optional samples of the whole grid, see SurfaceLevels::begin(). If they are given, no sample is
  // evaluated.
  PlanarPoints first_samples, second_samples;
};

// Result of SurfacePairCollider::collide().
struct PairResult {
  bool touching = false;   // true if the surfaces touch, to within touch_tolerance_m
  bool contained = false;  // true if one body is inside the other; the only contact pushes the inner body out
  // Distance of surfaces that do not touch; infinite if it is greater than the reach. It exceeds the true
  // distance by at most 1e-4 of the distance or of the smaller surface's size, whichever is larger.
  double distance_m = std::numeric_limits<double>::infinity();
  SurfacePair nearest;
  // True if a capacity was exceeded, so that a contact may be missing. Use surfaces with fewer elements, or a
  // smaller reach.
  bool overflow = false;
  int samples_evaluated = 0;
};

// Contact search of two surfaces. Reuses evaluated samples until control points move, and starts from the
// last contacts. Not thread-safe. Allocates only on construction. The grids must outlive the collider.
class SurfacePairCollider {
 public:
  SurfacePairCollider(const NestedGrid& first, const NestedGrid& second);
  SurfacePairCollider(const SurfacePairCollider&) = delete;
  SurfacePairCollider& operator=(const SurfacePairCollider&) = delete;

  // Finds the contacts, or the nearest points within the query's reach if the surfaces do not touch.
  PairResult collide(const Surface& first, const Surface& second, const PairQuery& query);

  // Returns the contacts of the last collide(), one for each region.
  const std::vector<PairContact>& contacts() const { return contacts_; }
  // Returns the cell pairs of the last search at which the surfaces may meet, including regions without
  // contact.
  const std::vector<CellPair>& cells() const { return cells_.pairs(); }

  // Returns the cell search, for overlays after collide() of the same surfaces. Its searches change cells().
  CellPairs& cell_pairs() { return cells_; }
  SurfaceLevels& first_levels() { return first_; }
  SurfaceLevels& second_levels() { return second_; }

 private:
  // Starting parameters on each side of the second surface: index 0 behind it, index 1 in front of it.
  struct Seeds {
    double centre_depth = 0.0;
    double depth[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    PairParameters at[2];
  };
  using Pairs = std::vector<CellPair>;
  using Region = ContactRegions::Region;

  // Points of a region from which the next collide() starts: the point where the surfaces touched, and the
  // points where the first surface was deepest on either side of the second.
  struct Seed {
    PairParameters touch, deepest[2];
    bool deep[2] = {false, false};
  };

  void find_contacts(const PairQuery& query);
  const Seed* last_seed(const PairContact& contact) const;
  bool touches(const RegionCells& cells, const Seed* last);
  Seed resolve_contact(const RegionCells& cells, const PairQuery& query, const Seed* last,
                       PairContact& contact) const;
  RegionCentre find_centre(const RegionCells& cells) const;
  Seeds find_seeds(const RegionCells& cells, const Seed* last) const;
  void find_inner_touch(const RegionCells& cells, PairContact& contact) const;
  void deepen_contact(PairContact& contact, PairParameters& from, double outside, bool first_closed,
                      double shortest) const;
  void find_nearest(const PairQuery& query, PairResult& result);
  bool may_contain(const PairQuery& query) const;
  double tolerance() const;
  double search_all(double reach);
  bool is_contained(const PairQuery& query) const;
  PairContact make_containment_contact() const;

  SurfaceLevels first_, second_;
  CellPairs cells_;
  ContactRegions regions_;
  PairSearch search_;
  std::vector<PairContact> contacts_;
  // Starting points stored by the present collide() and by the previous one.
  std::vector<Seed> seeds_, last_seeds_;
  std::size_t query_ = 0;
  // Nearest points in the most recent collide() that found the surfaces apart.
  PairParameters nearest_;
  bool nearest_known_ = false;
  // True if the surfaces met in the last collide(). Affects the order of the search, not its result.
  bool touched_last_ = false;
};

}  // namespace spoonbill
