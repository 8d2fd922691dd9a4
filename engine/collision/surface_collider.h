// Contact of a tool with one B-spline surface, through levels of detail of its blending matrices (section 4.1
// of Pungotra et al. 2013): sparse samples, spheres that provably cover their patch, refinement where a
// sphere meets the tool, then the nearest point polished on the true surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/surface.h"
#include "engine/collision/surface_bounds.h"
#include "engine/collision/tool_shape.h"
#include "engine/result.h"

namespace spoonbill {

struct SurfaceContact {
  double u = 0.0, v = 0.0;
  Vector3 point_m = Vector3::Zero();  // on the surface
  Vector3 normal = Vector3::UnitY();  // unit, along du x dv
  double depth_m = 0.0;               // of the tool in the surface's inside; negative where they are apart
};

// A sample of the finest level within the margin of the tool.
struct NearSample {
  int index = 0;            // into the grid
  double distance_m = 0.0;  // to the tool's surface, negative inside the tool
};

struct CollisionResult {
  bool found = false;      // whether the surface comes within the margin (or encloses the tool), to 1e-6 m
  SurfaceContact nearest;  // the deepest contact: none is deeper by 2e-5 m; valid when found
  bool overflow = false;   // a capacity was met; `nearest` is still the best of what was searched
  int samples_evaluated = 0;
};

struct NestedGrid {
  Grid grid;
  int levels_u = 0, levels_v = 0;  // strides halve level by level until both are 1
};

// Parameters nested so that no cell holds a knot inside and each element has 2^levels cells a direction.
Result<NestedGrid> make_nested_grid(const KnotVector& u, const KnotVector& v, int levels);

// One owner, one thread; allocates only when made. The grid must outlive it.
class SurfaceCollider {
 public:
  explicit SurfaceCollider(const NestedGrid& nested);

  // The surface must have the grid's knots. `closed` says that the surface bounds a body, so that a sphere's
  // centre may be inside it. Samples nearer than `margin_m` are in near_samples() afterwards.
  CollisionResult collide(const Surface& surface, const ToolShape& tool, double margin_m, bool closed);

  const std::vector<NearSample>& near_samples() const { return near_; }

  // The sphere that covers a cell of the finest grid between samples (i, j) and (i + 1, j + 1) strides
  // further, for tests and overlays. Call after collide().
  struct Cover {
    Vector3 centre;
    double radius;
  };
  Cover cover(const Surface& surface, int i, int j, int level);

 private:
  struct Cell {
    int i, j, level;
  };
  struct Patch {
    double u0, u1, v0, v1;
    std::array<Vector3, 4> corners;  // (u0, v0), (u0, v1), (u1, v0), (u1, v1)
    int element_u, element_v, depth;
  };

  const Vector3& sample(const Surface& surface, int index);
  void sample_column(const Surface& surface, int column);
  void offer_coarsest(const Surface& surface, const ToolShape& tool, double margin);
  void descend(const Surface& surface, const ToolShape& tool, double margin, CollisionResult& result);
  void visit_cell(const Surface& surface, const ToolShape& tool, const Cell& cell, double reach,
                  CollisionResult& result);
  void search_between_samples(const Surface& surface, const ToolShape& tool, CollisionResult& result);
  void cut(const Surface& surface, const ToolShape& tool, const Patch& patch);
  void offer(const ToolShape& tool, double u, double v, const Vector3& point);
  void polish(const Surface& surface, const ToolShape& tool);
  double reach(double margin) const;

  const NestedGrid* nested_;
  SurfaceBounds bounds_;
  std::vector<Vector3> samples_;
  std::vector<Vector3> lines_;             // working memory: a column's sums along v, one a control row
  std::vector<std::uint32_t> sampled_at_;  // the query in which a sample was evaluated
  std::uint32_t query_ = 0;
  int samples_evaluated_ = 0;
  std::vector<double> column_bound_;  // of the tool's distance, for the elements of each span of v
  std::vector<Cell> cells_, finest_;
  std::vector<Patch> patches_;
  std::vector<NearSample> near_;
  std::vector<std::uint32_t> near_at_;
  double best_distance_ = 0.0, best_u_ = 0.0, best_v_ = 0.0;
  Vector3 best_point_ = Vector3::Zero();
};

}  // namespace spoonbill
