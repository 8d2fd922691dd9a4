// Whether a surface bounds a body as it should, and what there is to know of its shape: for reports, not for
// the tick. Deterministic; any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/inspection/closing.h"
#include "engine/inspection/curvature_range.h"
#include "engine/inspection/enclosed_mass.h"
#include "engine/inspection/thickness.h"

namespace spoonbill {

// A place other than a pole where du x dv vanishes, or turns over from one side to the other within a smooth
// part of the surface.
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
  Closing closing;          // of the surface as if it had no trims
  bool is_trimmed = false;  // what follows is of what is kept
  EnclosedMass mass;        // volume and middle where it encloses() only
  CurvatureRange curvature;
  double bending = 0.0;  // see bending_measure()
  std::vector<BadSpot> bad_spots;
  std::vector<SelfMeeting> self_intersections;
  bool self_meetings_complete = true;      // false where there were too many to be searched
  std::optional<Thickness> thinnest = {};  // where it encloses()

  // Whether it bounds a body by itself.
  bool encloses() const { return closing.closedness == Closedness::solid && !is_trimmed; }
};

// Nothing where it was stopped.
std::optional<SurfaceCheck> check_surface(const Surface& surface, const TrimmedArea& area = {},
                                          const Progress& progress = {});

}  // namespace spoonbill
