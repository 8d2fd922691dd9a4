// Thickness of closed bodies: the distance from a surface point straight inwards to where the line leaves the
// body through a wall. It is measured on one surface, or on a mesh and then corrected to the exact surfaces.
// The search may run on any thread and is too slow for a tick.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/inspection/curvature.h"

namespace spoonbill {

// An inward line from a surface point to the opposite wall: its length, and the parameters and positions of
// both ends.
struct Thickness {
  double thickness_m = 0.0;
  double u = 0.0, v = 0.0, opposite_u = 0.0, opposite_v = 0.0;
  Vector3 position_m = Vector3::Zero(), opposite_m = Vector3::Zero();
};

// The point where a line leaves a body through a surface.
struct SurfaceExit {
  double distance_m = 0.0;
  double u = 0.0, v = 0.0;
};

// Thickness search on one surface, which must outlive the search. The surface has outward normals. It is
// closed, or it is one of several surfaces that together bound a body. Immutable.
class ThicknessSearch {
 public:
  explicit ThicknessSearch(const Surface& surface);

  // Returns the first exit along a unit direction, or nothing if it is not through a wall
  // (exits_through_wall()). The exit is exact up to rounding where Newton's method converges; elsewhere it is
  // on a facet.
  std::optional<SurfaceExit> exit(const Vector3& from, const Vector3& direction) const;

  // Returns the thickness at a surface point. Returns nothing where the surface has no normal, or where the
  // inward line leaves through no wall (exits_through_wall()). Near an edge the line may leave too obliquely
  // or miss the facets between the samples.
  std::optional<Thickness> at(double u, double v) const;

  // Returns the smallest thickness at the samples, refined around the best of them. A wall thinner than the
  // spacing of the samples is found only if the line of a sample crosses it.
  std::optional<Thickness> smallest(const Progress& progress = {}) const;

 private:
  // Parameters of a facet's corners.
  struct Parameters {
    std::array<double, 3> u, v;
  };
  std::vector<Triangle> facets();
  SurfaceExit refine_exit(const LineExit& exit, const Vector3& from, const Vector3& direction) const;

  const Surface* surface_;
  std::vector<PieceCell> cells_;
  std::vector<Parameters> parameters_;
  LineExits exits_;
};

// A wall, measured from one side of a solid straight inwards to the other side.
struct WallThickness {
  double thickness_m = 0.0;
  Vector3 position_m = Vector3::Zero(), opposite_m = Vector3::Zero();
};

// Corrects thicknesses that were measured on a mesh to the exact surfaces that the mesh approximates. The
// surfaces must outlive the object, and all their normals must point out of the material. Immutable.
class ExactWalls {
 public:
  // `error_m` is the largest distance of the mesh from the surfaces, at least 0.
  ExactWalls(const std::vector<const Surface*>& surfaces, double error_m);

  // Returns the wall between the surfaces nearest to the ends of `mesh_wall`, along the normal of the first
  // surface, exact up to rounding. Returns nothing if an end is not near any surface. Also returns nothing if
  // the wall's thickness differs from that of `mesh_wall` by more than the mesh's error explains, as at a
  // sliver whose normal is wrong.
  std::optional<WallThickness> at(const WallThickness& mesh_wall) const;

 private:
  struct Face {
    const Surface* surface;
    Box net;
    ThicknessSearch search;
  };
  struct FoundExit {
    const Surface* surface;
    SurfaceExit exit;
  };
  std::optional<FoundExit> find_exit_near(const Vector3& from, const Vector3& expected,
                                          const Vector3& direction) const;

  std::vector<Face> faces_;
  double reach_m_;
};

}  // namespace spoonbill
