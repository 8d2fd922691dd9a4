// Whether a surface bounds a body as it should, and what there is to know of its shape: for reports, not for
// the tick. Deterministic; any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/study/closing.h"
#include "engine/study/curvature_range.h"
#include "engine/study/enclosed_mass.h"
#include "engine/study/thickness.h"

namespace spoonbill {

// A place other than a pole where du x dv vanishes, or turns over from one side to the other.
struct BadSpot {
  double u = 0.0, v = 0.0;
  Vector3 position_m = Vector3::Zero();
  bool folds = false;
};

struct SelfMeeting {
  double u = 0.0, v = 0.0, other_u = 0.0, other_v = 0.0, depth_m = 0.0;
  Vector3 position_m = Vector3::Zero();
};

struct SurfaceCheck {
  Closing closing;
  EnclosedMass mass;  // volume and middle of a solid only
  CurvatureRange curvature;
  double bending = 0.0;  // see bending_measure()
  std::vector<BadSpot> bad_spots;
  std::vector<SelfMeeting> self_meetings;
  bool self_meetings_complete = true;      // false where there were too many to be searched
  std::optional<Thickness> thinnest = {};  // of a solid
};

SurfaceCheck check_surface(const Surface& surface);

}  // namespace spoonbill
