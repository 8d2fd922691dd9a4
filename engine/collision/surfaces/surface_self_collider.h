// Contact of a B-spline surface, open, periodic or closed, with itself. The search is the same as in
// SurfacePairCollider, with the same surface as both arguments. Cells that are joined (at an edge or a
// corner, across a seam or at a pole) always meet there. They are split until PatchFolds proves that they
// meet nowhere else.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/surfaces/contact_regions.h"
#include "engine/collision/surfaces/pair_polish.h"
#include "engine/collision/surfaces/pair_search.h"

namespace spoonbill {

// Tangent cones of one surface's cells, which prove that patches do not intersect themselves. Not
// thread-safe. Allocates only on construction. The levels must outlive the object.
//
// Over a parameter rectangle, S(p) - S(q) = (u_p - u_q) a + (v_p - v_q) b. Here a and b are the means of S_u
// and S_v over the path from q to p. Each is therefore in the convex cone that contains the tangents S_u or
// S_v. Let these cones have the axes A and B and the half angles alpha and beta. If the angle between the
// lines of A and B is more than alpha + beta, a and b are never parallel and the difference never vanishes.
//
// This test is stronger than a cone of normals (Volino and Magnenat-Thalmann 1994), which also needs a test
// of the boundary: a flat spiral has only one normal and may still overlap itself.
class PatchFolds {
 public:
  explicit PatchFolds(SurfaceLevels& levels);

  // Updates the cones to the current shape of the surface. Call after SurfaceLevels::begin().
  void begin();

  // Returns true if it is proven that the patch of the cells does not intersect itself. The cells must be of
  // one level and form a rectangle, possibly across a seam.
  bool never_meets_itself(std::span<const LevelCell> cells);

 private:
  struct Cone {
    Vector3 axis = Vector3::Zero();  // unit axis of the cone
    double angle = 0.0;              // half angle; pi if the cone contains all directions
  };
  struct Cones {
    Cone along_u, along_v;
  };
  const Cones& cones_at(const LevelCell& cell);
  Cones compute_cones(const LevelCell& cell);
  void update_mixed_bounds();

  SurfaceLevels* levels_;
  // Upper bound of the norm of S_uv over each element, indexed by u and v. SurfaceBounds contains the bounds
  // for S_uu and S_vv.
  std::vector<double> mixed_;
  struct Direction {
    // Knot span of each element, and index of each control point along the direction. In a periodic
    // direction, the first control points are repeated at the end.
    std::vector<int> span, control;
    std::vector<double> scale;  // degree / (u_{i+p+1} - u_{i+1}) for each index i of `control`
    int degree = 0;
  };
  static Direction unroll(const KnotVector& knots);
  Direction u_, v_;
  // Working memory: norms of the control points of S_uv, with the same repetition as in Direction::control.
  std::vector<double> steps_;
  std::vector<Cones> cones_;  // indexed by SurfaceLevels::cell_index()
  std::vector<std::uint32_t> computed_at_;
  std::uint32_t generation_ = 0;
};

// Options of SurfaceSelfCollider::collide().
struct SelfQuery {
  // True if the surface bounds a body: du x dv then points outward. For an open surface, the depth is
  // measured on both sides, and the smaller value counts.
  bool closed = false;
  Progress progress = {};  // receives the fraction searched; may stop the search
};

// Result of SurfaceSelfCollider::collide().
struct SelfResult {
  bool touching = false;  // true if the surface touches itself, to within touch_tolerance_m
  // True if a capacity was exceeded, so that a contact may be missing. Use a surface with fewer elements, or
  // fewer levels.
  bool overflow = false;
  bool stopped = false;  // true if the progress callback stopped the search; contacts found so far are valid
};

// Search for contacts of one surface with itself. Not thread-safe. Allocates only on construction. The grid
// must outlive the search.
//
// Neighbouring cells of the finest level are not tested against each other, and neither are cells that meet
// across a seam or at a pole. A loop within two such cells, or the sharp edge of a fold, is therefore not
// reported as a contact. With more levels, smaller loops are found.
class SurfaceSelfCollider {
 public:
  explicit SurfaceSelfCollider(const NestedGrid& nested);
  SurfaceSelfCollider(const SurfaceSelfCollider&) = delete;
  SurfaceSelfCollider& operator=(const SurfaceSelfCollider&) = delete;

  SelfResult collide(const Surface& surface, const SelfQuery& query);

  // Returns the contacts of the last collide(), one for each region. In a contact, either of the two touching
  // parts of the surface may be the first.
  const std::vector<PairContact>& contacts() const { return contacts_; }

 private:
  // How cells at the two ends of a direction are joined, apart from the corners that they share in the grid.
  struct Joints {
    // True if both ends of the direction are the same curve in space.
    bool seam = false;
    // True if the low or high end of the direction is a single point.
    bool low_pole = false, high_pole = false;
  };
  // Rejects pairs of points that are in joined cells.
  class NotJoinedJudge final : public PairJudge {
   public:
    explicit NotJoinedJudge(const SurfaceSelfCollider& of) : collider_(&of) {}
    bool counts(const PairParameters& at) const override;

   private:
    const SurfaceSelfCollider* collider_;
  };
  using Pairs = std::vector<CellPair>;
  using Region = ContactRegions::Region;

  Joints find_joints(bool in_u);
  bool are_joined(const LevelCell& a, const LevelCell& b) const;
  LevelCell cell_at(double u, double v) const;
  void collect_pairs(int level);
  void descend(const CellPair& elements, int level);
  bool can_meet(const CellPair& pair, int level);
  bool joined_can_meet(const CellPair& pair);
  void add_pair(const CellPair& pair, int level);
  void split(const CellPair& pair);
  bool is_mirror_of_earlier(const Region& region) const;
  bool touches(const RegionCells& cells);
  bool should_continue(double fraction);
  PairContact make_contact(const RegionCells& cells, const SelfQuery& query) const;
  void deepen_contact(PairContact& contact, const PairParameters& from, double outside,
                      const SelfQuery& query, double& shortest) const;

  SurfaceLevels levels_;
  ElementTree tree_;
  PatchFolds folds_;
  NotJoinedJudge not_joined_;
  PairSearch search_;
  ContactRegions regions_;
  Joints u_, v_;
  Pairs pairs_;                            // pairs of cells, each in both orders
  std::vector<CellPair> pending_;          // working memory: stack of cell pairs still to be split
  std::vector<std::array<int, 2>> nodes_;  // working memory: stack of node pairs
  std::vector<PairContact> contacts_;
  bool overflow_ = false, stopped_ = false;
  const SelfQuery* query_ = nullptr;  // query of the current collide()
  std::uint64_t calls_ = 0;
};

}  // namespace spoonbill
