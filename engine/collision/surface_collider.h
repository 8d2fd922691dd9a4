// Contact of a tool with one B-spline surface, through levels of detail of its blending matrices (section 4.1
// of Pungotra et al. 2013): sparse samples, spheres that provably cover their patch, refinement where a
// sphere meets the tool, then the nearest point polished on the true surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/surface_levels.h"
#include "engine/collision/tool_shape.h"

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

// One owner, one thread; allocates only when made. The grid must outlive it.
class SurfaceCollider {
 public:
  explicit SurfaceCollider(const NestedGrid& nested);

  // The surface must have the grid's knots. `closed` says that the surface bounds a body, so that a sphere's
  // centre may be inside it. Samples nearer than `margin_m` are in near_samples() afterwards.
  CollisionResult collide(const Surface& surface, const ToolShape& tool, double margin_m, bool closed);

  const std::vector<NearSample>& near_samples() const { return near_; }

  // For tests and overlays, after collide().
  SurfaceLevels& levels() { return levels_; }

 private:
  struct Patch {
    double u0, u1, v0, v1;
    PatchCorners corners;
    int element_u, element_v, depth;
  };

  void offer_coarsest(const ToolShape& tool, double margin);
  void descend(const ToolShape& tool, double margin, CollisionResult& result);
  void take_near_samples(const ToolShape& tool, double margin, CollisionResult& result);
  void visit_cell(const ToolShape& tool, const LevelCell& cell, double reach, CollisionResult& result);
  void search_between_samples(const Surface& surface, const ToolShape& tool, CollisionResult& result);
  void cut(const Surface& surface, const ToolShape& tool, const Patch& patch);
  void offer(const ToolShape& tool, double u, double v, const Vector3& point);
  void polish(const Surface& surface, const ToolShape& tool);
  double reach(double margin) const;

  SurfaceLevels levels_;
  std::vector<double> column_bound_;  // of the tool's distance, for the elements of each span of v
  std::vector<LevelCell> cells_, finest_;
  std::vector<Patch> patches_;
  std::vector<NearSample> near_;
  std::vector<std::uint32_t> near_at_;  // the query in which a sample was looked at
  std::uint32_t query_ = 0;
  double best_distance_ = 0.0, best_u_ = 0.0, best_v_ = 0.0;
  Vector3 best_point_ = Vector3::Zero();
};

}  // namespace spoonbill
