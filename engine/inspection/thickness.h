// How thick a closed body is: from a point of its surface straight inwards to where the line comes out again
// through a wall. Outside the tick; any thread.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/inspection/piece_sampling.h"

namespace spoonbill {

// Where a line inwards from a place of the surface leaves the body.
struct Thickness {
  double thickness_m = 0.0;
  double u = 0.0, v = 0.0, opposite_u = 0.0, opposite_v = 0.0;
  Vector3 position_m = Vector3::Zero(), opposite_m = Vector3::Zero();
};

// Where a line goes out through a surface.
struct SurfaceExit {
  double distance_m = 0.0;
  double u = 0.0, v = 0.0;
};

// One owner. The surface, which is closed or one of several that close together, and whose normals point
// outwards, must outlive it.
class ThicknessSearch {
 public:
  explicit ThicknessSearch(const Surface& surface);

  // Along a unit direction, through a wall (exits_through_wall()); to rounding where Newton's method finds to it.
  std::optional<SurfaceExit> exit(const Vector3& from, const Vector3& direction) const;

  // None where there is no normal, or the line meets the surface nowhere, as between samples at an edge, or
  // beside an edge alone (exits_through_wall()).
  std::optional<Thickness> at(double u, double v) const;

  // From samples, refined about the least of them. A wall thinner than a cell of samples is wide is found
  // where a sample looks through it.
  std::optional<Thickness> smallest(const Progress& progress = {}) const;

 private:
  // Of the corners of a facet.
  struct Parameters {
    std::array<double, 3> u, v;
  };
  std::vector<Triangle> facets();
  SurfaceExit settled(const LineExit& exit, const Vector3& from, const Vector3& direction) const;

  const Surface* surface_;
  std::vector<PieceCell> cells_;
  std::vector<Parameters> parameters_;
  LineExits exits_;
};

}  // namespace spoonbill
