// Contact of a tool with one B-spline surface, which may be trimmed, through levels of detail of the surface
// (section 4.1 of Pungotra et al. 2013). A sphere around each coarse cell covers its patch; cells whose
// sphere meets the tool are refined. Newton's method then finds the nearest point on the exact surface.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/surface_contact.h"
#include "engine/collision/solids/tool_shape.h"

namespace spoonbill {

// Table of the cells and samples of a trimmed surface that are not trimmed away. Immutable; queries allocate
// nothing.
class TrimmedLevels {
 public:
  TrimmedLevels(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> area);

  bool contains(double u, double v) const { return area_->contains(u, v); }
  bool has_sample(int index) const { return present_samples_[static_cast<std::size_t>(index)] != 0; }

  // Returns true if the cell, of any level, is entirely trimmed away.
  bool is_trimmed_away(const LevelCell& cell) const;
  // Returns true if trim loops cross the cell, which must be at the finest level.
  bool is_cut(const LevelCell& cell) const {
    return cells_.state(cell.i, cell.j) == TrimmedCells::State::cut;
  }
  std::span<const TrimmedArea::Edge> edges(const LevelCell& cell) const {
    return cells_.edges(cell.i, cell.j);
  }

 private:
  int levels_;
  int columns_;  // number of finest cells in a row
  std::shared_ptr<const TrimmedArea> area_;
  TrimmedCells cells_;
  std::vector<std::uint8_t> present_samples_;
  std::vector<int> present_;  // number of finest cells that are not trimmed away, as a summed area table
};

// A sample of the finest grid that is within the margin of the tool.
struct NearSample {
  int index = 0;            // index of the sample in the grid
  double distance_m = 0.0;  // signed distance from the tool; negative inside it
};

// Largest number of patches that one search cuts between samples. It bounds the time of a tick: a crumpled
// surface would otherwise be cut everywhere into patches as small as the tolerance.
inline constexpr int surface_cut_limit = 20000;

// Result of SurfaceCollider::collide().
struct CollisionResult {
  // True if the surface is within the margin or encloses the tool. May be false for a surface that is barely
  // within the margin: by less than 1e-6 m for a margin of 0, otherwise by less than the accuracy of
  // `nearest`.
  bool found = false;
  // Deepest contact, valid if `found` is true. No point is deeper by more than 2e-5 m, or 5e-5 m for a
  // non-convex solid of unknown concavity.
  SurfaceContact nearest;
  // True if a capacity was exceeded; `nearest` is then the best contact in the part that was searched.
  bool overflow = false;
  int samples_evaluated = 0;
  int cuts = 0;  // number of patches cut between samples, at most surface_cut_limit
};

// Guaranteed distance between a tool and the surface: three quarters of the nearest distance, or 0 if they
// touch to within touch_tolerance_m.
struct Clearance {
  double guaranteed_m = 0.0;
  SurfaceContact nearest;
  bool overflow = false;  // true if a capacity was exceeded; the distance is then not guaranteed
};

// Contact search of one surface with a tool. Reuses evaluated samples until control points move, and starts
// from the last nearest point. Not thread-safe. Allocates only on construction. The grid must outlive the
// collider.
class SurfaceCollider {
 public:
  // The optional `trim` restricts the surface to the trimmed area. Nearest points on trim loops are points of
  // the polygons that replace the loops. In cells that loops cross, the nearest point is the best that
  // Newton's method finds, starting from samples and loop points; it is not proven to be the nearest.
  explicit SurfaceCollider(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> trim = nullptr);

  // Finds the deepest contact within `margin_m`. The surface must have the grid's knots. `closed` is true if
  // the surface bounds a body, which may contain the tool. The depth of a contained tool is the distance that
  // the tool must move along the normal of the nearest wall to leave the body. Afterwards, near_samples()
  // returns the samples within the margin. `samples` are optional, see SurfaceLevels::begin().
  CollisionResult collide(const Surface& surface, const ToolShape& tool, double margin_m, bool closed,
                          const PlanarPoints& samples = {});

  // Finds every region of the surface that the tool touches, deepest first. Must be called after collide()
  // with the same tool. The surface given to collide() must still exist and must not have changed. The result
  // is valid until the next call of a member function.
  const std::vector<ToolContactRegion>& find_contact_regions(const ToolShape& tool);
  // Returns true if the last find_contact_regions() exceeded a capacity, so that regions or parts of them may
  // be missing.
  bool regions_overflow() const { return regions_overflow_; }

  // Returns a lower bound of the distance between the tool and the surface. A tool inside a closed surface
  // counts as separate from the surface unless the tool touches the wall.
  Clearance clearance(const Surface& surface, const ToolShape& tool);

  const std::vector<NearSample>& near_samples() const { return near_; }
  // Removes the samples near the last tool. For a tool that is known to be far from the surface.
  void clear_near_samples() { near_.clear(); }

  // Returns the levels of detail of the surface in the last collide(). For tests and overlays.
  SurfaceLevels& levels() { return levels_; }
  // Returns the cells that the last search visited, level by level. The children of a refined cell are
  // consecutive, in the order of the refined cells.
  const std::vector<LevelCell>& visited_cells() const { return cells_; }
  // Returns the finest cells that the last search did not rule out as too far from the tool, in the order of
  // visited_cells().
  const std::vector<LevelCell>& finest_cells() const { return finest_; }

 private:
  struct Patch {
    double u0, u1, v0, v1;
    PatchCorners corners;
    int element_u, element_v, depth;
  };
  // Parameters and position of a patch's centre, with the values of the basis functions there.
  struct PatchCentre {
    double u, v;
    PieceBasis::Values basis_u, basis_v;
    Vector3 position_m;
  };

  // Goal of a search: the deepest contact within the tolerance, or a guaranteed clearance.
  enum class Proof { deepest, clearance };

  // The private functions below must be called after SurfaceLevels::begin().
  void find_nearest(const ToolShape& tool, double margin, Proof proof, CollisionResult& result);
  void offer_last(const ToolShape& tool);
  void offer_coarsest(const ToolShape& tool, double margin);
  void descend(const ToolShape& tool, double margin, CollisionResult& result);
  void collect_near_samples(const ToolShape& tool, double margin, CollisionResult& result);
  void visit_cell(const ToolShape& tool, const LevelCell& cell, double reach, CollisionResult& result);
  double enough() const;
  void search_between_samples(const ToolShape& tool, const LevelCell& cell, bool& overflow);
  Patch whole_patch(const LevelCell& cell);
  double bulge(const Patch& patch);
  bool can_cut(const Patch& patch) const;
  PatchCentre find_centre(const Patch& patch) const;
  void cut(const Patch& patch, const PatchCentre& at);
  void offer(const ToolShape& tool, double u, double v, const Vector3& point);
  void update_best(const ToolShape& tool, double u, double v, const Vector3& point);
  bool is_trimmed_away(const LevelCell& cell) const { return trimmed_ && trimmed_->is_trimmed_away(cell); }
  bool is_cut(const LevelCell& cell) const { return trimmed_ && trimmed_->is_cut(cell); }
  // The trim loop edge that is nearest to the tool, and the edge that meets it at the nearest point.
  struct TrimEdges {
    const TrimmedArea::Edge* first = nullptr;
    const TrimmedArea::Edge* second = nullptr;
  };
  void offer_trim_loops(const ToolShape& tool);
  void offer_trim_edges(const ToolShape& tool, const LevelCell& cell, TrimEdges& nearest);
  void minimise_on_edges(const ToolShape& tool, const TrimEdges& nearest);
  void search_trimmed_cell(const ToolShape& tool, const LevelCell& cell);
  bool touches_trimmed_cell(const ToolShape& tool, const LevelCell& cell);
  void polish(const ToolShape& tool);
  void polish_analytic(const ToolShape& tool);
  double depth_inside(const ToolShape& tool, const SurfaceContact& nearest) const;
  double reach(double margin) const;

  void reserve_regions();
  int finest_index(int i, int j) const;
  int region_at(double u, double v) const;
  bool touches(const ToolShape& tool, const LevelCell& cell);
  void find_touched_cells(const ToolShape& tool);
  void join_neighbours(int first, int region);
  void add_region(const ToolShape& tool, int begin, int end);

  SurfaceLevels levels_;
  std::shared_ptr<const TrimmedLevels> trimmed_;  // null if the surface is not trimmed
  // column_bound_ has, for each span of v, a lower bound of the tool's distance from all elements of the
  // span. row_bound_ has the same for each span of u.
  std::vector<double> column_bound_, row_bound_;
  std::vector<LevelCell> cells_, finest_;
  std::vector<Patch> patches_;
  std::vector<NearSample> near_;
  std::vector<std::uint32_t> near_at_;  // serial number of the query that last visited each sample
  std::uint32_t query_ = 0;
  SurfaceSpot best_;
  SurfaceSpot last_;       // best point of the previous query
  bool has_last_ = false;  // true after the first query
  bool moved_ = true;      // true if the surface moved since the boxes were updated
  Proof proof_ = Proof::deepest;
  double tolerance_ = 0.0;
  int cuts_left_ = 0;

  // A finest cell that the tool touches. The cells of one region are consecutive in grouped_.
  struct TouchedCell {
    LevelCell cell;
    int region;  // -1 until it is assigned
  };
  std::vector<TouchedCell> touched_;
  std::vector<int> grouped_;        // indices into touched_, grouped by region
  std::vector<int> touched_index_;  // index into touched_ of each cell, by finest_index()
  // For each cell, the serial number of the query in which the tool last touched it.
  std::vector<std::uint32_t> touched_at_;
  std::vector<ToolContactRegion> regions_;
  int region_ = -1;  // region that Newton's method must not leave; -1 for none
  bool regions_overflow_ = false;
};

}  // namespace spoonbill
