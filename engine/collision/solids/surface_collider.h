// Contact of a tool with one B-spline surface, through levels of detail of its blending matrices (section 4.1
// of Pungotra et al. 2013): sparse samples, spheres that provably cover their patch, refinement where a
// sphere meets the tool, then the nearest point polished on the true surface.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/solids/solid_polish.h"
#include "engine/collision/solids/surface_contact.h"
#include "engine/collision/solids/tool_shape.h"
#include "engine/collision/solids/trimmed_levels.h"

namespace spoonbill {

// A sample of the finest level within the margin of the tool.
struct NearSample {
  int index = 0;            // into the grid
  double distance_m = 0.0;  // to the tool's surface, negative inside the tool
};

struct CollisionResult {
  bool found = false;  // whether the surface comes within the margin (or encloses the tool), to 1e-6 m
  // The deepest contact, valid when found: none is deeper by 2e-5 m, or by 5e-5 m in a solid that is not
  // convex and does not know its concavity.
  SurfaceContact nearest;
  bool overflow = false;  // a capacity was met; `nearest` is still the best of what was searched
  int samples_evaluated = 0;
};

// How far a tool surely is from the surface: three quarters of the way to the nearest point; 0 where they
// touch, to touch_tolerance_m.
struct Clearance {
  double surely_m = 0.0;
  SurfaceContact nearest;
  bool overflow = false;  // a capacity was met, and nothing is sure
};

// Keeps what it evaluated of a surface until its control points move, and looks first where it last found the
// nearest point. One owner, one thread; allocates only when made. The grid must outlive it.
class SurfaceCollider {
 public:
  // Of a trimmed surface only what `trim` keeps is there. Nearest points on its loops are those of its
  // polygons, and in cells that loops cross, what Newton's method finds from samples and loops.
  explicit SurfaceCollider(const NestedGrid& nested, std::shared_ptr<const TrimmedArea> trim = nullptr);

  // The surface must have the grid's knots. `closed` says that the surface bounds a body, so that the tool
  // may be inside it: its depth is then the way along the nearest wall's normal that takes it out. Samples
  // nearer than `margin_m` are in near_samples() afterwards. Where all samples of the grid are known already,
  // they may be given (see SurfaceLevels::begin()).
  CollisionResult collide(const Surface& surface, const ToolShape& tool, double margin_m, bool closed,
                          const PlanarPoints& samples = {});

  // After collide() of the same surface and tool: every region of the surface that the tool touches, the
  // deepest first. Valid until the next call of anything here.
  const std::vector<ToolContactRegion>& take_regions(const Surface& surface, const ToolShape& tool);
  // Whether a capacity was met in the last take_regions(), and regions or parts of them may be missing.
  bool regions_overflow() const { return regions_overflow_; }

  // For the same surface, without its inside.
  Clearance clearance(const Surface& surface, const ToolShape& tool);

  const std::vector<NearSample>& near_samples() const { return near_; }

  // For tests and overlays, after collide().
  SurfaceLevels& levels() { return levels_; }
  // The cells that were looked at, level by level. Those within a cell that was kept follow each other, in
  // the order of the cells that were kept.
  const std::vector<LevelCell>& visited_cells() const { return cells_; }
  // Those of the finest level that were kept, in the same order.
  const std::vector<LevelCell>& finest_cells() const { return finest_; }

 private:
  struct Patch {
    double u0, u1, v0, v1;
    PatchCorners corners;
    int element_u, element_v, depth;
  };

  // What a search must prove: the deepest contact to the tolerance, or a clearance.
  enum class Proof { deepest, clearance };

  // After SurfaceLevels::begin().
  void find_nearest(const Surface& surface, const ToolShape& tool, double margin, Proof proof,
                    CollisionResult& result);
  void offer_last(const Surface& surface, const ToolShape& tool);
  void offer_coarsest(const ToolShape& tool, double margin);
  void descend(const ToolShape& tool, double margin, CollisionResult& result);
  void take_near_samples(const ToolShape& tool, double margin, CollisionResult& result);
  void visit_cell(const ToolShape& tool, const LevelCell& cell, double reach, CollisionResult& result);
  double enough() const;
  void search_between_samples(const Surface& surface, const ToolShape& tool, const LevelCell& cell,
                              bool& overflow);
  Patch whole(const LevelCell& cell);
  double bulge(const Patch& patch);
  bool can_cut(const Patch& patch) const;
  void cut(const Surface& surface, const Patch& patch, const Vector3& centre);
  void offer(const ToolShape& tool, double u, double v, const Vector3& point);
  void take_nearer(const ToolShape& tool, double u, double v, const Vector3& point);
  bool is_away(const LevelCell& cell) const { return trimmed_ && trimmed_->is_away(cell); }
  bool is_cut(const LevelCell& cell) const { return trimmed_ && trimmed_->is_cut(cell); }
  // The edge of a loop that came nearest, and one that meets it there.
  struct RimEdges {
    const TrimmedArea::Edge* first = nullptr;
    const TrimmedArea::Edge* second = nullptr;
  };
  void offer_rims(const Surface& surface, const ToolShape& tool);
  void offer_rim(const Surface& surface, const ToolShape& tool, const LevelCell& cell, RimEdges& nearest);
  void narrow(const Surface& surface, const ToolShape& tool, const RimEdges& nearest);
  void search_cut_cell(const Surface& surface, const ToolShape& tool, const LevelCell& cell);
  bool touches_cut(const Surface& surface, const ToolShape& tool, const LevelCell& cell);
  void polish(const Surface& surface, const ToolShape& tool);
  void polish_by_form(const Surface& surface, const ToolShape& tool);
  double depth_inside(const ToolShape& tool, const SurfaceContact& nearest) const;
  double reach(double margin) const;

  void reserve_regions();
  int finest_index(int i, int j) const;
  int region_at(double u, double v) const;
  bool touches(const Surface& surface, const ToolShape& tool, const LevelCell& cell);
  void take_touched(const Surface& surface, const ToolShape& tool);
  void join_neighbours(int first, int region);
  void add_region(const Surface& surface, const ToolShape& tool, int begin, int end);

  SurfaceLevels levels_;
  std::shared_ptr<const TrimmedLevels> trimmed_;  // null: all of the surface is there
  // Of the tool's distance, for the elements of each span of v and of each span of u.
  std::vector<double> column_bound_, row_bound_;
  std::vector<LevelCell> cells_, finest_;
  std::vector<Patch> patches_;
  std::vector<NearSample> near_;
  std::vector<std::uint32_t> near_at_;  // the query in which a sample was looked at
  std::uint32_t query_ = 0;
  SurfaceSpot best_;
  SurfaceSpot last_;    // the best of the query before
  bool asked_ = false;  // whether there was one
  bool moved_ = true;   // since the boxes were taken
  Proof proof_ = Proof::deepest;
  double tolerance_ = 0.0;
  int cuts_left_ = 0;

  // The finest cells that the tool touches, those of a region beside each other once they are grouped.
  struct TouchedCell {
    LevelCell cell;
    int region;  // -1 before it is known
  };
  std::vector<TouchedCell> touched_;
  std::vector<int> grouped_;               // into touched_
  std::vector<int> touched_index_;         // by finest_index(), into touched_
  std::vector<std::uint32_t> touched_at_;  // the query in which the tool touched the cell
  std::vector<ToolContactRegion> regions_;
  int region_ = -1;  // which the search must not leave
  bool regions_overflow_ = false;
};

}  // namespace spoonbill
