// From where a mesh is thin to where the surfaces are that it stands for. Outside the tick; any thread.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/bspline/surface.h"
#include "engine/inspection/thickness.h"

namespace spoonbill {

// Of a solid, from one side straight inwards to the other.
struct WallThickness {
  double thickness_m = 0.0;
  Vector3 position_m = Vector3::Zero(), opposite_m = Vector3::Zero();
};

// One owner. The surfaces must outlive it; the normals of all point out of the material.
class ExactWalls {
 public:
  // `error_m` is how far the mesh is from them.
  ExactWalls(const std::vector<const Surface*>& surfaces, double error_m);

  // The wall between those surfaces that are nearest to its ends: from one of them straight inwards, by its
  // own normal, to the other, to rounding. None where there are no such two, or they are farther from each
  // other or nearer than the mesh's error can tell, as where a sliver of the mesh faces askew.
  std::optional<WallThickness> at(const WallThickness& of_mesh) const;

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
  std::optional<FoundExit> exit_near(const Vector3& from, const Vector3& expected,
                                     const Vector3& direction) const;

  std::vector<Face> faces_;
  double reach_m_;
};

}  // namespace spoonbill
